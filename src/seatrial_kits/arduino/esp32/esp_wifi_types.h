/* Types of the radio. */
#ifndef ESP_WIFI_TYPES_H
#define ESP_WIFI_TYPES_H

#include <stdint.h>

typedef enum { WIFI_IF_STA, WIFI_IF_AP } wifi_interface_t;
#define ESP_IF_WIFI_STA WIFI_IF_STA
#define ESP_IF_WIFI_AP WIFI_IF_AP
typedef enum { WIFI_SECOND_CHAN_NONE, WIFI_SECOND_CHAN_ABOVE, WIFI_SECOND_CHAN_BELOW } wifi_second_chan_t;
typedef enum { WIFI_PKT_MGMT, WIFI_PKT_CTRL, WIFI_PKT_DATA, WIFI_PKT_MISC } wifi_promiscuous_pkt_type_t;
typedef struct {
    signed rssi : 8;
    unsigned channel : 4, sig_len : 12;
} wifi_pkt_rx_ctrl_t;
typedef struct {
    wifi_pkt_rx_ctrl_t rx_ctrl;
    uint8_t payload[0];
} wifi_promiscuous_pkt_t;
typedef struct {
    uint32_t filter_mask;
} wifi_promiscuous_filter_t;
typedef void (*wifi_promiscuous_cb_t)(void *packet, wifi_promiscuous_pkt_type_t type);
#define WIFI_PROMIS_FILTER_MASK_ALL 0xFFFFFFFF
#define WIFI_PROMIS_FILTER_MASK_MGMT 1
#define WIFI_PROMIS_FILTER_MASK_CTRL 2
#define WIFI_PROMIS_FILTER_MASK_DATA 4
#define WIFI_PROTOCOL_11B 1
#define WIFI_PROTOCOL_11G 2
#define WIFI_PROTOCOL_11N 4
#define WIFI_PROTOCOL_LR 8

#endif
