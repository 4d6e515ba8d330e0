// Relay of Gloria's telemetry, for an Arduino Uno: receives from the Mega on its only UART, and sends the
// shore a line a second on the same UART's transmitter, where the modem is.

char line[84];
byte length = 0;
unsigned long lastSent = 0;
unsigned int number = 0;

void setup() {
  Serial.begin(19200);
  pinMode(LED_BUILTIN, OUTPUT);
}

void loop() {
  while (Serial.available()) {
    char c = Serial.read();
    if (c == '$') length = 0;
    if (c == '\r' || c == '\n') {
      line[length] = 0;
      if (strncmp_P(line, PSTR("$GLO,"), 5) == 0 && millis() - lastSent >= 1000) {
        lastSent = millis();
        forward(line + 5);
      }
      length = 0;
    } else if (length < sizeof(line) - 1) {
      line[length++] = c;
    }
  }
}

void forward(const char *text) {
  char head[16];
  snprintf(head, sizeof(head), "SHORE %05u ", number++);
  Serial.print(head);
  Serial.println(text);
  digitalWrite(LED_BUILTIN, !digitalRead(LED_BUILTIN));
}
