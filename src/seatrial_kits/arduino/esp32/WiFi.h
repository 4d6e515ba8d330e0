/* WiFi that is connected at once; its packets go where the component's parameter `network` says. */
#ifndef WiFi_h
#define WiFi_h

#include <functional>
#include <utility>
#include <vector>

#include "Arduino.h"
#include "WiFiClient.h"
#include "WiFiServer.h"
#include "WiFiUdp.h"

typedef enum { WL_NO_SHIELD = 255, WL_IDLE_STATUS = 0, WL_NO_SSID_AVAIL, WL_SCAN_COMPLETED, WL_CONNECTED, WL_CONNECT_FAILED, WL_CONNECTION_LOST, WL_DISCONNECTED } wl_status_t;
typedef enum { WIFI_OFF, WIFI_STA, WIFI_AP, WIFI_AP_STA } wifi_mode_t;
typedef enum { WIFI_PS_NONE, WIFI_PS_MIN_MODEM, WIFI_PS_MAX_MODEM } wifi_ps_type_t;
typedef enum { WIFI_POWER_19_5dBm = 78, WIFI_POWER_19dBm = 76, WIFI_POWER_18_5dBm = 74, WIFI_POWER_17dBm = 68, WIFI_POWER_15dBm = 60, WIFI_POWER_13dBm = 52, WIFI_POWER_11dBm = 44, WIFI_POWER_8_5dBm = 34, WIFI_POWER_7dBm = 28, WIFI_POWER_5dBm = 20, WIFI_POWER_2dBm = 8, WIFI_POWER_MINUS_1dBm = -4 } wifi_power_t;
typedef enum { WIFI_AUTH_OPEN, WIFI_AUTH_WEP, WIFI_AUTH_WPA_PSK, WIFI_AUTH_WPA2_PSK, WIFI_AUTH_WPA_WPA2_PSK, WIFI_AUTH_WPA2_ENTERPRISE, WIFI_AUTH_WPA3_PSK } wifi_auth_mode_t;
typedef enum {
    ARDUINO_EVENT_WIFI_READY, ARDUINO_EVENT_WIFI_SCAN_DONE, ARDUINO_EVENT_WIFI_STA_START, ARDUINO_EVENT_WIFI_STA_STOP, ARDUINO_EVENT_WIFI_STA_CONNECTED, ARDUINO_EVENT_WIFI_STA_DISCONNECTED, ARDUINO_EVENT_WIFI_STA_AUTHMODE_CHANGE, ARDUINO_EVENT_WIFI_STA_GOT_IP, ARDUINO_EVENT_WIFI_STA_GOT_IP6, ARDUINO_EVENT_WIFI_STA_LOST_IP,
    ARDUINO_EVENT_WIFI_AP_START, ARDUINO_EVENT_WIFI_AP_STOP, ARDUINO_EVENT_WIFI_AP_STACONNECTED, ARDUINO_EVENT_WIFI_AP_STADISCONNECTED, ARDUINO_EVENT_WIFI_AP_STAIPASSIGNED, ARDUINO_EVENT_WIFI_AP_PROBEREQRECVED, ARDUINO_EVENT_MAX
} arduino_event_id_t;
typedef arduino_event_id_t WiFiEvent_t;
typedef struct {
    struct { uint8_t reason; } wifi_sta_disconnected;
    struct { uint8_t mac[6]; } wifi_ap_staconnected, wifi_ap_stadisconnected;
} arduino_event_info_t;
typedef arduino_event_info_t WiFiEventInfo_t;
#define SYSTEM_EVENT_STA_GOT_IP ARDUINO_EVENT_WIFI_STA_GOT_IP
#define SYSTEM_EVENT_STA_CONNECTED ARDUINO_EVENT_WIFI_STA_CONNECTED
#define SYSTEM_EVENT_STA_DISCONNECTED ARDUINO_EVENT_WIFI_STA_DISCONNECTED
#define SYSTEM_EVENT_AP_STACONNECTED ARDUINO_EVENT_WIFI_AP_STACONNECTED
#define SYSTEM_EVENT_AP_STADISCONNECTED ARDUINO_EVENT_WIFI_AP_STADISCONNECTED
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
    bool enableSTA(bool) { return true; }
    bool enableAP(bool) { return true; }
    bool setAutoConnect(bool) { return true; }
    bool setMinSecurity(wifi_auth_mode_t) { return true; }
    wifi_power_t getTxPower() { return WIFI_POWER_19_5dBm; }
    bool getSleep() { return false; }
    uint8_t *BSSID() { static uint8_t none[6]; return none; }
    String BSSIDstr() { return "00:00:00:00:00:00"; }
    String psk() { return ""; }
    IPAddress dnsIP(uint8_t = 0) { return gatewayIP(); }
    String softAPSSID() { return ssid_; }
    const char *softAPgetHostname() { return getHostname(); }
    void printDiag(Print &to) { to.println("SSID: " + ssid_); }
    /* There is one network, the one that was last named; until then there is none. */
    int16_t scanNetworks(bool = false, bool = false, bool = false, uint32_t = 300, uint8_t = 0) { return scanComplete(); }
    int16_t scanComplete() { return ssid_.length() ? 1 : 0; }
    void scanDelete() {}
    String SSID(uint8_t) { return ssid_; }
    int32_t RSSI(uint8_t) { return RSSI(); }
    int32_t channel(uint8_t) { return channel(); }
    String BSSIDstr(uint8_t) { return BSSIDstr(); }
    wifi_auth_mode_t encryptionType(uint8_t) { return WIFI_AUTH_WPA2_PSK; }
    /* Handlers are called from begin() and softAP(). */
    int onEvent(std::function<void(WiFiEvent_t)> handler, WiFiEvent_t one = ARDUINO_EVENT_MAX) { return onEvent([=](WiFiEvent_t event, WiFiEventInfo_t) { handler(event); }, one); }
    int onEvent(std::function<void(WiFiEvent_t, WiFiEventInfo_t)> handler, WiFiEvent_t one = ARDUINO_EVENT_MAX) { handlers_.emplace_back(one, handler); return (int)handlers_.size(); }
    void removeEvent(int number) { handlers_.at((size_t)number - 1).second = nullptr; }
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
    void tell(WiFiEvent_t event);
    std::vector<std::pair<WiFiEvent_t, std::function<void(WiFiEvent_t, WiFiEventInfo_t)>>> handlers_;
    bool joined_ = false;
    wifi_mode_t mode_ = WIFI_OFF;
    String ssid_;
};

extern WiFiClass WiFi;

#endif
