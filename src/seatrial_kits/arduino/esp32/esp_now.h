/* ESP-NOW: frames to and from the wire `espnow` of the profile; see espnow.cpp. */
#ifndef ESP_NOW_H
#define ESP_NOW_H

#include "esp_wifi.h"

#define ESP_NOW_ETH_ALEN 6
#define ESP_NOW_KEY_LEN 16
#define ESP_NOW_MAX_TOTAL_PEER_NUM 20
#define ESP_NOW_MAX_DATA_LEN 250
#define ESP_ERR_ESPNOW_NOT_INIT 0x3065
#define ESP_ERR_ESPNOW_ARG 0x3066
#define ESP_ERR_ESPNOW_FULL 0x3068
#define ESP_ERR_ESPNOW_NOT_FOUND 0x3069
#define ESP_ERR_ESPNOW_EXIST 0x306B

typedef enum { ESP_NOW_SEND_SUCCESS, ESP_NOW_SEND_FAIL } esp_now_send_status_t;
typedef struct {
    uint8_t peer_addr[ESP_NOW_ETH_ALEN];
    uint8_t lmk[ESP_NOW_KEY_LEN];
    uint8_t channel;
    wifi_interface_t ifidx;
    bool encrypt;
    void *priv;
} esp_now_peer_info_t;
typedef struct {
    int total_num, encrypt_num;
} esp_now_peer_num_t;
/* Of Arduino-ESP32 3. */
typedef struct {
    uint8_t *src_addr, *des_addr;
    wifi_pkt_rx_ctrl_t *rx_ctrl;
} esp_now_recv_info_t;
typedef struct {
    uint8_t *des_addr, *src_addr;
    wifi_interface_t ifidx;
} esp_now_send_info_t;

/* A handler as before Arduino-ESP32 3: of a sketch that has both, the newer is taken. */
template <typename F> struct EspNowOlder {
    template <typename T, typename = std::enable_if_t<std::is_convertible_v<T, F *>>> EspNowOlder(T handler) : handler(handler) {}
    EspNowOlder(F *handler) : handler(handler) {}
    F *handler;
};

esp_err_t esp_now_init();
esp_err_t esp_now_deinit();
esp_err_t esp_now_register_recv_cb(void (*handler)(const esp_now_recv_info_t *info, const uint8_t *data, int size));
esp_err_t esp_now_register_recv_cb(EspNowOlder<void(const uint8_t *mac, const uint8_t *data, int size)> handler);
esp_err_t esp_now_unregister_recv_cb();
esp_err_t esp_now_register_send_cb(void (*handler)(const esp_now_send_info_t *info, esp_now_send_status_t status));
esp_err_t esp_now_register_send_cb(EspNowOlder<void(const uint8_t *mac, esp_now_send_status_t status)> handler);
esp_err_t esp_now_unregister_send_cb();
esp_err_t esp_now_send(const uint8_t *mac, const uint8_t *data, size_t size); /* null: to all peers */
esp_err_t esp_now_add_peer(const esp_now_peer_info_t *peer);
esp_err_t esp_now_mod_peer(const esp_now_peer_info_t *peer);
esp_err_t esp_now_del_peer(const uint8_t *mac);
bool esp_now_is_peer_exist(const uint8_t *mac);
esp_err_t esp_now_get_peer_num(esp_now_peer_num_t *number);
inline esp_err_t esp_now_set_pmk(const uint8_t *) { return ESP_OK; }

#endif
