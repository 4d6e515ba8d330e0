// Hydrone holds a heading, by an ESP32 with two tasks.
//
// compass:    NMEA 0183 on Serial2 (pins 26 and 27), sentence HDT
// gyroscope:  MPU-6050 on I2C, z down
// thrusters:  speed controllers, port 13, starboard 14; 1100 to 1900 us, 1500 stops
// telemetry:  Serial; "H 45" asks for another heading, which the flash keeps
//
// Core 0 reads the compass, core 1 steers.

#include <ESP32Servo.h>
#include <Preferences.h>
#include <Wire.h>

const int MPU = 0x68;
const float SURGE = 15.0;                               // N
const float GAIN = 20.0, DAMPING = 30.0, LIMIT = 16.0;  // N.m/rad, N.m.s/rad, N.m
const float ARM = 0.35;                                 // m from the middle to a thruster

Servo port, starboard;
Preferences kept;
QueueHandle_t headings;  // rad
float wanted;            // deg

float wrapped(float angle) { return remainder(angle, TWO_PI); }

// $HEHDT,123.4,T*hh
void takeSentence(const String &line) {
  int star = line.indexOf('*');
  if (!line.startsWith("$") || star < 0 || line.substring(3, 7) != "HDT,") return;
  uint8_t sum = 0;
  for (int at = 1; at < star; at++) sum ^= line[at];
  if (strtol(line.c_str() + star + 1, nullptr, 16) != sum) return;
  float heading = line.substring(7).toFloat() * DEG_TO_RAD;
  xQueueOverwrite(headings, &heading);
}

void readCompass(void *) {
  String line;
  for (;;) {
    while (Serial2.available()) {
      char c = Serial2.read();
      if (c == '$') line = "";
      if (c == '\n') takeSentence(line);
      else if (line.length() < 82) line += c;
    }
    vTaskDelay(pdMS_TO_TICKS(5));
  }
}

float yawRate() {  // rad/s, positive to starboard
  Wire.beginTransmission(MPU);
  Wire.write(0x47);  // z axis
  Wire.endTransmission(false);
  if (Wire.requestFrom(MPU, 2) != 2) return 0;
  int high = Wire.read(), low = Wire.read();
  return int16_t(high << 8 | low) / 131.0f * DEG_TO_RAD;
}

// A T200's pulse for a thrust, N: its thrust grows with the square of the pulse beyond the dead band.
void drive(Servo &thruster, float thrust) {
  float away = 0;
  if (fabsf(thrust) > 0.2f) {
    away = thrust > 0 ? 25 + 375 * sqrtf(thrust / 51) : -25 - 375 * sqrtf(-thrust / 40);
  }
  thruster.writeMicroseconds(1500 + (int)constrain(away, -400.0f, 400.0f));
}

void steer(void *) {
  TickType_t last = xTaskGetTickCount();
  float heading;
  for (;;) {
    vTaskDelayUntil(&last, pdMS_TO_TICKS(50));
    if (!xQueuePeek(headings, &heading, 0)) continue;
    float moment = GAIN * wrapped(wanted * DEG_TO_RAD - heading) - DAMPING * yawRate();
    moment = constrain(moment, -LIMIT, LIMIT);
    drive(port, SURGE / 2 + moment / (2 * ARM));
    drive(starboard, SURGE / 2 - moment / (2 * ARM));
  }
}

void setup() {
  Serial.begin(115200);
  Serial2.begin(38400, SERIAL_8N1, 26, 27);
  port.attach(13);
  starboard.attach(14);
  port.writeMicroseconds(1500);
  starboard.writeMicroseconds(1500);
  Wire.begin();
  Wire.beginTransmission(MPU);
  Wire.write(0x6B);  // wakes it up
  Wire.write(0);
  Wire.endTransmission();
  kept.begin("helm");
  wanted = kept.getFloat("heading", 90);
  headings = xQueueCreate(1, sizeof(float));
  xTaskCreatePinnedToCore(readCompass, "compass", 4096, nullptr, 2, nullptr, 0);
  xTaskCreatePinnedToCore(steer, "steer", 4096, nullptr, 3, nullptr, 1);
}

void loop() {
  if (Serial.available() && Serial.read() == 'H') {
    wanted = Serial.parseFloat();
    kept.putFloat("heading", wanted);
  }
  float heading;
  if (xQueuePeek(headings, &heading, 0)) Serial.printf("%.1f of %.1f\n", heading * RAD_TO_DEG, wanted);
  delay(1000);
}
