/* TWAI: the CAN controller of the ESP32, at the simulated CAN bus. */
#ifndef DRIVER_TWAI_H
#define DRIVER_TWAI_H

#include "../Arduino.h"
#include "gpio.h"

#define TWAI_FRAME_MAX_DLC 8
#define TWAI_STD_ID_MASK 0x7FF
#define TWAI_EXTD_ID_MASK 0x1FFFFFFF
#define TWAI_MSG_FLAG_NONE 0x00
#define TWAI_MSG_FLAG_EXTD 0x01
#define TWAI_MSG_FLAG_RTR 0x02
#define TWAI_MSG_FLAG_SS 0x04
#define TWAI_MSG_FLAG_SELF 0x08
#define TWAI_ALERT_TX_IDLE 0x1
#define TWAI_ALERT_TX_SUCCESS 0x2
#define TWAI_ALERT_RX_DATA 0x4
#define TWAI_ALERT_BELOW_ERR_WARN 0x8
#define TWAI_ALERT_ERR_ACTIVE 0x10
#define TWAI_ALERT_RECOVERY_IN_PROGRESS 0x20
#define TWAI_ALERT_BUS_RECOVERED 0x40
#define TWAI_ALERT_ARB_LOST 0x80
#define TWAI_ALERT_ABOVE_ERR_WARN 0x100
#define TWAI_ALERT_BUS_ERROR 0x200
#define TWAI_ALERT_TX_FAILED 0x400
#define TWAI_ALERT_RX_QUEUE_FULL 0x800
#define TWAI_ALERT_ERR_PASS 0x1000
#define TWAI_ALERT_BUS_OFF 0x2000
#define TWAI_ALERT_ALL 0x1FFFF
#define TWAI_ALERT_NONE 0
#define TWAI_IO_UNUSED GPIO_NUM_NC

typedef enum { TWAI_MODE_NORMAL, TWAI_MODE_NO_ACK, TWAI_MODE_LISTEN_ONLY } twai_mode_t;
typedef enum { TWAI_STATE_STOPPED, TWAI_STATE_RUNNING, TWAI_STATE_BUS_OFF, TWAI_STATE_RECOVERING } twai_state_t;
typedef struct { uint32_t bits; } twai_timing_config_t;
typedef struct { uint32_t acceptance_code, acceptance_mask; bool single_filter; } twai_filter_config_t;
typedef struct {
    twai_mode_t mode;
    gpio_num_t tx_io, rx_io, clkout_io, bus_off_io;
    uint32_t tx_queue_len, rx_queue_len, alerts_enabled, clkout_divider;
    int intr_flags;
} twai_general_config_t;
typedef struct {
    union {
        struct { uint32_t extd : 1, rtr : 1, ss : 1, self : 1, dlc_non_comp : 1, reserved : 27; };
        uint32_t flags;
    };
    uint32_t identifier;
    uint8_t data_length_code;
    uint8_t data[TWAI_FRAME_MAX_DLC];
} twai_message_t;
typedef struct {
    twai_state_t state;
    uint32_t msgs_to_tx, msgs_to_rx, tx_error_counter, rx_error_counter, tx_failed_count, rx_missed_count, rx_overrun_count, arb_lost_count, bus_error_count;
} twai_status_info_t;

#define TWAI_TIMING_CONFIG_25KBITS() {25000}
#define TWAI_TIMING_CONFIG_50KBITS() {50000}
#define TWAI_TIMING_CONFIG_100KBITS() {100000}
#define TWAI_TIMING_CONFIG_125KBITS() {125000}
#define TWAI_TIMING_CONFIG_250KBITS() {250000}
#define TWAI_TIMING_CONFIG_500KBITS() {500000}
#define TWAI_TIMING_CONFIG_800KBITS() {800000}
#define TWAI_TIMING_CONFIG_1MBITS() {1000000}
#define TWAI_FILTER_CONFIG_ACCEPT_ALL() {0, 0xFFFFFFFF, true}
#define TWAI_GENERAL_CONFIG_DEFAULT(tx, rx, mode) {mode, tx, rx, TWAI_IO_UNUSED, TWAI_IO_UNUSED, 5, 5, TWAI_ALERT_NONE, 0, 0}

esp_err_t twai_driver_install(const twai_general_config_t *general, const twai_timing_config_t *timing, const twai_filter_config_t *filter);
esp_err_t twai_driver_uninstall();
esp_err_t twai_start();
esp_err_t twai_stop();
esp_err_t twai_transmit(const twai_message_t *message, TickType_t ticks);
esp_err_t twai_receive(twai_message_t *message, TickType_t ticks);
esp_err_t twai_read_alerts(uint32_t *alerts, TickType_t ticks);
esp_err_t twai_reconfigure_alerts(uint32_t enabled, uint32_t *before);
esp_err_t twai_initiate_recovery();
esp_err_t twai_get_status_info(twai_status_info_t *status);
esp_err_t twai_clear_transmit_queue();
esp_err_t twai_clear_receive_queue();

#endif
