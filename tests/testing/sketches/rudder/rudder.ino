// H and microseconds: the servo's pulse from its middle. Anything else is an error.
#include <Servo.h>

Servo rudder;
String line;

void setup() {
  Serial.begin(115200);
  rudder.attach(9);
  rudder.writeMicroseconds(1500);
  Serial.println("READY");
}

void loop() {
  while (Serial.available()) {
    char c = Serial.read();
    if (c != '\n') {
      line += c;
      continue;
    }
    if (line.startsWith("H")) {
      rudder.writeMicroseconds(1500 + line.substring(1).toInt());
      Serial.println("OK");
    } else {
      Serial.println("ERR");
    }
    line = "";
  }
}
