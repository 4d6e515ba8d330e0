"""What libraries include of the network below WiFi."""

DATA_FILES = ("tcpbase.h",)
