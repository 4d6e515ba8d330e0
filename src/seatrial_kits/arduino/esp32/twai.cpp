/* TWAI: messages to and from the bus, as driver/twai.h has them; ESP-IDF's programming guide, "TWAI". */
#include "driver/twai.h"

#include <deque>

#include "machine.h"
#include "tasks.h"

using machine::charge;

namespace {

/* To the bus: a frame, or the rate. From the bus: a frame, or that one was sent. See can_port.py. */
enum Kind : uint8_t { FRAME, SENT, RATE };
#pragma pack(push, 1)
struct Message {
    Kind kind;
    uint8_t flags, length;
    uint32_t number; /* identifier, or bit/s */
    uint8_t data[8];
};
#pragma pack(pop)

twai_general_config_t general;
twai_filter_config_t filter;
bool installed, running;
std::deque<twai_message_t> received;
uint32_t on_the_way, missed, alerts;

void put(Kind kind, uint32_t number, const twai_message_t *frame = nullptr)
{
    Message one = {kind, 0, 0, number, {}};
    if (frame) {
        one.flags = (uint8_t)(frame->extd | frame->rtr << 1);
        one.length = frame->data_length_code > 8 ? 8 : frame->data_length_code;
        memcpy(one.data, frame->data, one.length);
    }
    machine::send_message(machine::CAN_MESSAGES, &one, sizeof one);
}

/* Bits of the mask do not matter; of two filters, each half is one: for base frames their identifier. */
bool accepted(const Message &one)
{
    bool extended = one.flags & 1;
    uint32_t remote = one.flags >> 1 & 1;
    if (filter.single_filter) {
        uint32_t bits = extended ? one.number << 3 | remote << 2 : one.number << 21 | remote << 20 | (uint32_t)one.data[0] << 8 | one.data[1];
        return !((bits ^ filter.acceptance_code) & ~filter.acceptance_mask);
    }
    uint32_t bits = extended ? one.number >> 13 : one.number << 5 | remote << 4;
    auto passes = [&](int shift) { return !((bits ^ filter.acceptance_code >> shift) & ~(filter.acceptance_mask >> shift) & (extended ? 0xFFFF : 0xFFF0)); };
    return passes(16) || passes(0);
}

void take(const uint8_t *data, size_t size)
{
    Message one;
    if (!running || size != sizeof one)
        return;
    memcpy(&one, data, sizeof one);
    if (one.kind == SENT) {
        on_the_way -= on_the_way > 0;
        alerts |= TWAI_ALERT_TX_SUCCESS | (on_the_way ? 0 : TWAI_ALERT_TX_IDLE);
        return;
    }
    if (!accepted(one))
        return;
    if (received.size() >= general.rx_queue_len) {
        missed++;
        alerts |= TWAI_ALERT_RX_QUEUE_FULL;
        return;
    }
    twai_message_t frame = {};
    frame.extd = one.flags & 1;
    frame.rtr = one.flags >> 1 & 1;
    frame.identifier = one.number;
    frame.data_length_code = one.length;
    memcpy(frame.data, one.data, sizeof frame.data);
    received.push_back(frame);
    alerts |= TWAI_ALERT_RX_DATA;
}

} // namespace

esp_err_t twai_driver_install(const twai_general_config_t *given, const twai_timing_config_t *timing, const twai_filter_config_t *of)
{
    charge(1600);
    if (installed)
        return ESP_ERR_INVALID_STATE;
    general = *given;
    filter = *of;
    installed = true;
    machine::receive_messages(machine::CAN_MESSAGES, take);
    put(RATE, timing->bits);
    return ESP_OK;
}

esp_err_t twai_driver_uninstall()
{
    if (!installed || running)
        return ESP_ERR_INVALID_STATE;
    installed = false;
    received.clear();
    return ESP_OK;
}

esp_err_t twai_start()
{
    if (!installed || running)
        return ESP_ERR_INVALID_STATE;
    running = true;
    return ESP_OK;
}

esp_err_t twai_stop()
{
    if (!running)
        return ESP_ERR_INVALID_STATE;
    running = false;
    return ESP_OK;
}

esp_err_t twai_transmit(const twai_message_t *message, TickType_t ticks)
{
    charge(80);
    if (message->data_length_code > 8 && !message->dlc_non_comp)
        return ESP_ERR_INVALID_ARG;
    if (!running)
        return ESP_ERR_INVALID_STATE;
    if (general.mode == TWAI_MODE_LISTEN_ONLY)
        return ESP_ERR_NOT_SUPPORTED;
    if (!wait_until(after_ticks(ticks), [] { return on_the_way <= general.tx_queue_len; }))
        return general.tx_queue_len ? ESP_ERR_TIMEOUT : ESP_FAIL;
    on_the_way++;
    put(FRAME, message->identifier, message);
    return ESP_OK;
}

esp_err_t twai_receive(twai_message_t *message, TickType_t ticks)
{
    charge(40);
    if (!installed)
        return ESP_ERR_INVALID_STATE;
    if (!wait_until(after_ticks(ticks), [] { return !received.empty(); }))
        return ESP_ERR_TIMEOUT;
    *message = received.front();
    received.pop_front();
    return ESP_OK;
}

esp_err_t twai_read_alerts(uint32_t *found, TickType_t ticks)
{
    if (!installed)
        return ESP_ERR_INVALID_STATE;
    bool came = wait_until(after_ticks(ticks), [] { return (alerts & general.alerts_enabled) != 0; });
    *found = alerts & general.alerts_enabled;
    alerts = 0;
    return came ? ESP_OK : ESP_ERR_TIMEOUT;
}

esp_err_t twai_reconfigure_alerts(uint32_t enabled, uint32_t *before)
{
    if (before)
        *before = alerts;
    general.alerts_enabled = enabled;
    alerts = 0;
    return installed ? ESP_OK : ESP_ERR_INVALID_STATE;
}

esp_err_t twai_initiate_recovery() { return ESP_ERR_INVALID_STATE; /* it was not off the bus */ }
esp_err_t twai_clear_receive_queue() { received.clear(); return ESP_OK; }
esp_err_t twai_clear_transmit_queue() { return ESP_OK; }

esp_err_t twai_get_status_info(twai_status_info_t *status)
{
    charge(40);
    *status = {};
    status->state = running ? TWAI_STATE_RUNNING : TWAI_STATE_STOPPED;
    status->msgs_to_tx = on_the_way;
    status->msgs_to_rx = (uint32_t)received.size();
    status->rx_missed_count = missed;
    return installed ? ESP_OK : ESP_ERR_INVALID_STATE;
}
