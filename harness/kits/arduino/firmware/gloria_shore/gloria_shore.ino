// Link to the shore and lookout of the sailing robot Gloria, for an Arduino Uno with a GSM/GPRS shield.
//
// Mega:    Serial, 9600: its telemetry comes, marks and sightings go there
// modem:   SIM900 at pins 7 and 8, 9600, by AT commands
// camera:  Pixy on I2C; its first signature is a buoy, the second an obstacle
//
// Nothing here waits: the modem is talked to step by step, and whatever it says is read as lines.

#include <SoftwareSerial.h>
#include <Wire.h>

const byte CAMERA = 0x54, OBSTACLE = 2;
const unsigned long REPORT_MS = 3000, LOOK_MS = 100;
const float FOCAL = 208.5;  // pixels: 320 over 75 degrees

SoftwareSerial modem(7, 8);

// What is said to the modem on the way to a connection, the answer that leads on, and how long for, s.
struct Step { const char *command, *answer; byte patience; };
const Step STEPS[] = {
    {"AT", "OK", 2},
    {"ATE0", "OK", 2},
    {"AT+CIPSHUT", "SHUT OK", 5},
    {"AT+CREG?", "+CREG: 0,1", 2},
    {"AT+CGATT?", "+CGATT: 1", 2},
    {"AT+CSTT=\"internet\",\"\",\"\"", "OK", 5},
    {"AT+CIICR", "OK", 85},
    {"AT+CIFSR", "", 5},
    {"AT+CIPSTART=\"TCP\",\"shore\",5000", "CONNECT OK", 80},
};
const byte LAST = sizeof(STEPS) / sizeof(STEPS[0]), PROMPTED = LAST + 1, SENDING = LAST + 2;

byte at = 0;                  // step; LAST: connected and idle
bool said = false;
unsigned long saidAt = 0, reportedAt = 0, lookedAt = 0;
char telemetry[64] = "";      // the last whole line of the Mega
char ownLine[64], modemLine[64];
byte ownLength = 0, modemLength = 0;

void setup() {
  Serial.begin(9600);
  modem.begin(9600);
  Wire.begin();
  pinMode(LED_BUILTIN, OUTPUT);
}

void loop() {
  readMega();
  readModem();
  talk();
  if (millis() - lookedAt >= LOOK_MS) {
    lookedAt += LOOK_MS;
    look();
  }
}

// ---------------------------------------------------------------- Mega

void readMega() {
  while (Serial.available()) {
    char c = Serial.read();
    if (c == '$') ownLength = 0;
    if (c == '\n') {
      ownLine[ownLength] = 0;
      if (strncmp(ownLine, "$PGLT,", 6) == 0) strcpy(telemetry, ownLine);
      ownLength = 0;
    } else if (c != '\r' && ownLength < sizeof(ownLine) - 1) {
      ownLine[ownLength++] = c;
    }
  }
}

// ---------------------------------------------------------------- modem

void readModem() {
  while (modem.available()) {
    char c = modem.read();
    if (c == '>' && at == PROMPTED && modemLength == 0) {
      sendTelemetry();
    } else if (c == '\n' || c == '\r') {
      modemLine[modemLength] = 0;
      if (modemLength) takeModemLine();
      modemLength = 0;
    } else if (modemLength < sizeof(modemLine) - 1) {
      modemLine[modemLength++] = c;
    }
  }
}

bool begins(const char *with) { return strncmp(modemLine, with, strlen(with)) == 0; }

void go(byte to) {
  at = to;
  said = false;
  saidAt = millis();
}

void takeModemLine() {
  if (begins("$PGLM,")) {
    Serial.println(modemLine);
  } else if (begins("CLOSED") || begins("+PDP: DEACT") || begins("SEND FAIL") || begins("RDY")) {
    go(0);
  } else if (at < LAST) {
    if (said && begins(STEPS[at].answer)) {
      digitalWrite(LED_BUILTIN, at == LAST - 1);
      go(at + 1);
    } else if (said && (begins("ERROR") || begins("CONNECT FAIL"))) {
      go(at > 5 ? 2 : at);
    }
  } else if (begins("SEND OK")) {
    go(LAST);
  } else if (begins("ERROR")) {
    go(0);
  }
}

// Say what is next; say it again, or begin again, if there is no answer.
void talk() {
  unsigned long waited = millis() - saidAt;
  if (at < LAST) {
    if (!said && waited >= 200) {
      modem.print(STEPS[at].command);
      modem.print('\r');
      said = true;
      saidAt = millis();
    } else if (said && waited >= STEPS[at].patience * 1000UL) {
      go(at > 5 ? 0 : at);
    }
  } else if (at == LAST) {
    if (millis() - reportedAt >= REPORT_MS && telemetry[0]) {
      reportedAt = millis();
      modem.print(F("AT+CIPSEND="));
      modem.print(strlen(telemetry) + 2);
      modem.print('\r');
      go(PROMPTED);
    }
  } else if (waited >= (at == PROMPTED ? 5000UL : 90000UL)) {
    go(0);
  }
}

void sendTelemetry() {
  modem.print(telemetry);
  modem.print(F("\r\n"));
  go(SENDING);
}

// ---------------------------------------------------------------- camera

unsigned int cameraWord() {
  if (Wire.requestFrom(CAMERA, (byte)2) != 2) return 0;
  unsigned int low = Wire.read();
  return low | (unsigned int)Wire.read() << 8;
}

// Blocks of a frame, the largest first, as the camera streams them: a sync, a checksum, five words.
void look() {
  for (byte words = 0; words < 60; words++) {
    unsigned int word = cameraWord();
    if (word == 0) return;
    if (word == 0xAA55) continue;
    unsigned int block[5], sum = 0;
    for (byte i = 0; i < 5; i++) sum += block[i] = cameraWord();
    if (sum == word && block[0] == OBSTACLE) tell(block[1], block[3]);
  }
}

// Bearing and apparent size, tenths of a degree, to the Mega.
void tell(int x, int width) {
  char text[32], check[6];
  int bearing = lround(atan((x - 160) / FOCAL) * RAD_TO_DEG * 10), size = lround(2 * atan(width / (2 * FOCAL)) * RAD_TO_DEG * 10);
  snprintf(text, sizeof(text), "$PGLS,%d,%d", bearing, size);
  byte sum = 0;
  for (char *c = text + 1; *c; c++) sum ^= *c;
  snprintf(check, sizeof(check), "*%02X", sum);
  Serial.print(text);
  Serial.println(check);
}
