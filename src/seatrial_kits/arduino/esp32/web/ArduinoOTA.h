/* Updates of the program over the network: nobody sends one here, and its handlers are never called. */
#ifndef ARDUINO_OTA_H
#define ARDUINO_OTA_H

#include <functional>

#include "ESPmDNS.h"
#include "Update.h"
#include "WiFi.h"

typedef enum { OTA_AUTH_ERROR, OTA_BEGIN_ERROR, OTA_CONNECT_ERROR, OTA_RECEIVE_ERROR, OTA_END_ERROR } ota_error_t;

class ArduinoOTAClass {
public:
    typedef std::function<void()> THandlerFunction;
    ArduinoOTAClass &setPort(uint16_t) { return *this; }
    ArduinoOTAClass &setHostname(const char *name) { name_ = name; return *this; }
    String getHostname() { return name_; }
    ArduinoOTAClass &setPassword(const char *) { return *this; }
    ArduinoOTAClass &setPasswordHash(const char *) { return *this; }
    ArduinoOTAClass &setPartitionLabel(const char *) { return *this; }
    ArduinoOTAClass &setRebootOnSuccess(bool) { return *this; }
    ArduinoOTAClass &setMdnsEnabled(bool) { return *this; }
    ArduinoOTAClass &setTimeout(int) { return *this; }
    ArduinoOTAClass &onStart(THandlerFunction) { return *this; }
    ArduinoOTAClass &onEnd(THandlerFunction) { return *this; }
    ArduinoOTAClass &onError(std::function<void(ota_error_t)>) { return *this; }
    ArduinoOTAClass &onProgress(std::function<void(unsigned, unsigned)>) { return *this; }
    int getCommand() { return U_FLASH; }
    void begin() {}
    void end() {}
    void handle() {}

private:
    String name_ = "esp32";
};

inline ArduinoOTAClass ArduinoOTA;

#endif
