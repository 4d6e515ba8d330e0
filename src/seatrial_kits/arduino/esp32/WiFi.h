/* WiFi that is connected at once; its packets go where the component's parameter `network` says. */
#ifndef WiFi_h
#define WiFi_h

#include "Arduino.h"
#include "WiFiClient.h"
#include "WiFiServer.h"
#include "WiFiUdp.h"

typedef enum { WL_NO_SHIELD = 255, WL_IDLE_STATUS = 0, WL_NO_SSID_AVAIL, WL_SCAN_COMPLETED, WL_CONNECTED, WL_CONNECT_FAILED, WL_CONNECTION_LOST, WL_DISCONNECTED } wl_status_t;
typedef enum { WIFI_OFF, WIFI_STA, WIFI_AP, WIFI_AP_STA } wifi_mode_t;
typedef enum { WIFI_PS_NONE, WIFI_PS_MIN_MODEM, WIFI_PS_MAX_MODEM } wifi_ps_type_t;
typedef enum { WIFI_POWER_19_5dBm = 78, WIFI_POWER_19dBm = 76, WIFI_POWER_15dBm = 60, WIFI_POWER_8_5dBm = 34, WIFI_POWER_2dBm = 8 } wifi_power_t;
#define WIFI_MODE_NULL WIFI_OFF
#define WIFI_MODE_STA WIFI_STA
#define WIFI_MODE_AP WIFI_AP
#define WIFI_MODE_APSTA WIFI_AP_STA

class WiFiClass {
public:
    wl_status_t begin(const char *ssid = "", const char * = nullptr, int32_t = 0, const uint8_t * = nullptr, bool = true);
    wl_status_t begin(const String &ssid, const String & = "") { return begin(ssid.c_str()); }
    wl_status_t status() { return joined_ ? WL_CONNECTED : WL_DISCONNECTED; }
    bool isConnected() { return joined_; }
    uint8_t waitForConnectResult(unsigned long = 60000) { return status(); }
    bool disconnect(bool = false, bool = false) { joined_ = false; return true; }
    bool reconnect() { joined_ = true; return true; }
    bool softAP(const char *ssid, const char * = nullptr, int = 1, int = 0, int = 4, bool = false);
    bool softAP(const String &ssid, const String & = "") { return softAP(ssid.c_str()); }
    bool softAPConfig(IPAddress, IPAddress, IPAddress) { return true; }
    bool softAPdisconnect(bool = false) { return true; }
    uint8_t softAPgetStationNum() { return 1; }
    IPAddress softAPIP() { return localIP(); }
    IPAddress localIP();
    IPAddress gatewayIP() { return IPAddress(127, 0, 0, 1); }
    IPAddress subnetMask() { return IPAddress(255, 0, 0, 0); }
    IPAddress broadcastIP() { return IPAddress(255, 255, 255, 255); }
    IPAddress softAPBroadcastIP() { return broadcastIP(); }
    bool config(IPAddress, IPAddress, IPAddress, IPAddress = IPAddress(), IPAddress = IPAddress()) { return true; }
    bool mode(wifi_mode_t mode) { mode_ = mode; return true; }
    wifi_mode_t getMode() { return mode_; }
    bool setSleep(bool) { return true; }
    bool setSleep(wifi_ps_type_t) { return true; }
    bool setTxPower(wifi_power_t) { return true; }
    bool setHostname(const char *) { return true; }
    bool softAPsetHostname(const char *) { return true; }
    const char *getHostname() { return "esp32"; }
    bool setAutoReconnect(bool) { return true; }
    void persistent(bool) {}
    int8_t RSSI() { return -50; }
    int32_t channel() { return 1; }
    String SSID() { return ssid_; }
    String macAddress() { return "A4:00:00:00:00:01"; }
    uint8_t *macAddress(uint8_t *mac) { esp_read_mac(mac, ESP_MAC_WIFI_STA); return mac; }
    String softAPmacAddress() { return macAddress(); }
    int hostByName(const char *host, IPAddress &found);

private:
    bool joined_ = false;
    wifi_mode_t mode_ = WIFI_OFF;
    String ssid_;
};

extern WiFiClass WiFi;

#endif
