/* A serial port by Bluetooth: the line of UART 3, at its rate, and whoever is there has connected. */
#ifndef BLUETOOTHSERIAL_H
#define BLUETOOTHSERIAL_H

#include "Arduino.h"

#ifndef BOARD_ESP32
#error "Classic Bluetooth is the ESP32's alone: the ESP32-S3 and the ESP32-C3 have Bluetooth LE"
#endif
#define CONFIG_BT_ENABLED 1
#define CONFIG_BLUEDROID_ENABLED 1
#define CONFIG_BT_SPP_ENABLED 1

typedef enum { ESP_SPP_INIT_EVT, ESP_SPP_OPEN_EVT = 26, ESP_SPP_CLOSE_EVT, ESP_SPP_START_EVT, ESP_SPP_DATA_IND_EVT = 30, ESP_SPP_WRITE_EVT = 33, ESP_SPP_SRV_OPEN_EVT } esp_spp_cb_event_t;
typedef struct {
    struct { uint8_t rem_bda[6]; } srv_open;
} esp_spp_cb_param_t;
typedef void esp_spp_cb_t(esp_spp_cb_event_t event, esp_spp_cb_param_t *value);

class BluetoothSerial : public HardwareSerial {
public:
    BluetoothSerial() : HardwareSerial(board::UARTS - 1) {}
    bool begin(const String & = "ESP32", bool = false, bool = false);
    bool hasClient() { return baudRate() > 0; }
    bool connected(int = 0) { return hasClient(); }
    bool isReady(bool = false, int = 0) { return hasClient(); }
    bool connect(const String &) { return hasClient(); }
    bool connect(uint8_t *, int = 0) { return hasClient(); }
    bool connect() { return hasClient(); }
    bool disconnect() { end(); return true; }
    bool setPin(const char *) { return true; }
    void enableSSP() {}
    esp_err_t register_callback(esp_spp_cb_t *handler) { opened_ = handler; tell(); return ESP_OK; }
    void onData(std::function<void(const uint8_t *, size_t)>) __attribute__((error("handlers of Bluetooth data are not called here: ask available()")));

private:
    void tell();
    esp_spp_cb_t *opened_ = nullptr;
};

#endif
