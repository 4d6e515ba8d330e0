/* ESP-NOW: a frame is 6 bytes of destination, 6 of source and its data, on the line that the wire `espnow` names.
 * Who is connected there receives it, whatever its address; a task of its own calls the handlers. */
#include "esp_now.h"

#include <deque>
#include <vector>

#include "machine.h"
#include "tasks.h"

using machine::charge;

namespace {

constexpr unsigned PRIORITY = 22;
constexpr size_t ADDRESS = ESP_NOW_ETH_ALEN, WAITING = 32;
constexpr uint64_t ON_AIR = 16000; /* 1 ms, about what 250 bytes take at 1 Mbit/s with the acknowledgement */

std::deque<std::string> received, sent;
uint64_t sent_due;
std::vector<esp_now_peer_info_t> peers;
std::function<void(const std::string &)> on_received, on_sent;
bool begun, serving;

esp_now_peer_info_t *peer_of(const uint8_t *mac)
{
    for (esp_now_peer_info_t &one : peers)
        if (!memcmp(one.peer_addr, mac, ADDRESS))
            return &one;
    return nullptr;
}

void take(const uint8_t *data, size_t size)
{
    if (begun && size > 2 * ADDRESS && received.size() < WAITING)
        received.emplace_back((const char *)data, size);
}

bool listens = (machine::receive_messages(machine::RADIO_MESSAGES, take), true);

void serve(void *)
{
    for (;;) {
        wait_until(sent.empty() ? UINT64_MAX : sent_due, [] { return !received.empty() || !sent.empty(); });
        std::deque<std::string> &all = received.empty() ? sent : received;
        if (all.empty())
            continue;
        if (&all == &sent)
            wait_until(sent_due, [] { return false; });
        std::string frame = all.front();
        all.pop_front();
        if (auto &handler = &all == &sent ? on_sent : on_received)
            handler(frame);
    }
}

uint8_t *bytes(const std::string &frame, size_t at) { return (uint8_t *)&frame[at]; }
uint8_t *payload(const std::string &frame) { return bytes(frame, 2 * ADDRESS); }
int size_of(const std::string &frame) { return (int)(frame.size() - 2 * ADDRESS); }

esp_err_t send_to(const uint8_t *mac, const uint8_t *data, size_t size)
{
    std::string frame((const char *)mac, ADDRESS);
    uint8_t own[ADDRESS];
    esp_efuse_mac_get_default(own);
    frame.append((const char *)own, ADDRESS).append((const char *)data, size);
    machine::send_message(machine::RADIO_MESSAGES, frame.data(), frame.size());
    sent_due = machine::now + ON_AIR;
    sent.push_back(frame);
    let_others();
    return ESP_OK;
}

} // namespace

esp_err_t esp_now_init()
{
    charge(16000);
    begun = true;
    if (!serving)
        xTaskCreatePinnedToCore(serve, "wifi", 0, nullptr, PRIORITY, nullptr, 0);
    serving = true;
    return ESP_OK;
}

esp_err_t esp_now_deinit() { begun = false; peers.clear(); return ESP_OK; }

esp_err_t esp_now_register_recv_cb(EspNowOlder<void(const uint8_t *, const uint8_t *, int)> older)
{
    on_received = [=](const std::string &frame) { older.handler(bytes(frame, ADDRESS), payload(frame), size_of(frame)); };
    return ESP_OK;
}

esp_err_t esp_now_register_recv_cb(void (*handler)(const esp_now_recv_info_t *, const uint8_t *, int))
{
    on_received = [=](const std::string &frame) {
        wifi_pkt_rx_ctrl_t control = {-50, 1, 0};
        esp_now_recv_info_t info = {bytes(frame, ADDRESS), bytes(frame, 0), &control};
        handler(&info, payload(frame), size_of(frame));
    };
    return ESP_OK;
}

esp_err_t esp_now_register_send_cb(EspNowOlder<void(const uint8_t *, esp_now_send_status_t)> older)
{
    on_sent = [=](const std::string &frame) { older.handler(bytes(frame, 0), ESP_NOW_SEND_SUCCESS); };
    return ESP_OK;
}

esp_err_t esp_now_register_send_cb(void (*handler)(const esp_now_send_info_t *, esp_now_send_status_t))
{
    on_sent = [=](const std::string &frame) {
        esp_now_send_info_t info = {bytes(frame, 0), bytes(frame, ADDRESS), WIFI_IF_STA};
        handler(&info, ESP_NOW_SEND_SUCCESS);
    };
    return ESP_OK;
}

esp_err_t esp_now_unregister_recv_cb() { on_received = nullptr; return ESP_OK; }
esp_err_t esp_now_unregister_send_cb() { on_sent = nullptr; return ESP_OK; }

esp_err_t esp_now_send(const uint8_t *mac, const uint8_t *data, size_t size)
{
    charge(1600);
    if (!begun)
        return ESP_ERR_ESPNOW_NOT_INIT;
    if (!data || !size || size > ESP_NOW_MAX_DATA_LEN)
        return ESP_ERR_ESPNOW_ARG;
    if (mac)
        return peer_of(mac) ? send_to(mac, data, size) : ESP_ERR_ESPNOW_NOT_FOUND;
    for (const esp_now_peer_info_t &one : std::vector<esp_now_peer_info_t>(peers))
        send_to(one.peer_addr, data, size);
    return peers.empty() ? ESP_ERR_ESPNOW_NOT_FOUND : ESP_OK;
}

esp_err_t esp_now_add_peer(const esp_now_peer_info_t *peer)
{
    if (!begun)
        return ESP_ERR_ESPNOW_NOT_INIT;
    if (peer_of(peer->peer_addr))
        return ESP_ERR_ESPNOW_EXIST;
    if (peers.size() == ESP_NOW_MAX_TOTAL_PEER_NUM)
        return ESP_ERR_ESPNOW_FULL;
    peers.push_back(*peer);
    return ESP_OK;
}

esp_err_t esp_now_mod_peer(const esp_now_peer_info_t *peer)
{
    esp_now_peer_info_t *found = peer_of(peer->peer_addr);
    if (found)
        *found = *peer;
    return found ? ESP_OK : ESP_ERR_ESPNOW_NOT_FOUND;
}

esp_err_t esp_now_del_peer(const uint8_t *mac)
{
    esp_now_peer_info_t *found = peer_of(mac);
    if (found)
        peers.erase(peers.begin() + (found - peers.data()));
    return found ? ESP_OK : ESP_ERR_ESPNOW_NOT_FOUND;
}

bool esp_now_is_peer_exist(const uint8_t *mac) { return peer_of(mac); }

esp_err_t esp_now_get_peer_num(esp_now_peer_num_t *number)
{
    *number = {(int)peers.size(), 0};
    return ESP_OK;
}
