"""What sketches have of the web: servers, clients, names and updates."""

DATA_FILES = (
    "ArduinoOTA.h",
    "AsyncTCP.h",
    "DNSServer.h",
    "ESPmDNS.h",
    "HTTPClient.h",
    "HTTP_Method.h",
    "MD5Builder.h",
    "Update.h",
    "Uri.h",
    "WebServer.h",
    "WiFiClientSecure.h",
    "WiFiMulti.h",
    "asynctcp.cpp",
    "digests.cpp",
    "dnsserver.cpp",
    "httpclient.cpp",
    "statuses.h",
    "webserver.cpp",
)
