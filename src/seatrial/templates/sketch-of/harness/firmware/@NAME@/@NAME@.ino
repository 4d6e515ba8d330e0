// Holds a heading at a slow speed, for an Arduino Mega: a start for the sketch of @NAME@.
//
// compass:    NMEA 0183 on Serial1, sentence HDT (RMC of the GNSS comes there too)
// gyroscope:  MPU-6050 on I2C, z down
// thrusters:  speed controllers, port 9, starboard 10; 1100 to 1900 us, 1500 stops
// telemetry:  Serial
//
// The numbers are invented: replace gains and limits by those of your boat.

#include <Servo.h>
#include <Wire.h>

const byte MPU = 0x68;
const float WANTED = 90.0 * DEG_TO_RAD;  // heading, clockwise from north
const float SURGE = 15.0;                // N
const float GAIN = 20.0, DAMPING = 30.0, LIMIT = 16.0;  // N.m/rad, N.m.s/rad, N.m
const float ARM = 0.35;                  // m from the middle to a thruster

Servo port, starboard;
float heading = 0, yawRate = 0;  // rad, rad/s, positive to starboard
bool haveHeading = false;
char line[84];
byte lineLength = 0;

void setup() {
  Serial.begin(115200);
  Serial1.begin(38400);
  port.attach(9);
  starboard.attach(10);
  port.writeMicroseconds(1500);
  starboard.writeMicroseconds(1500);
  Wire.begin();
  Wire.beginTransmission(MPU);
  Wire.write(0x6B);  // wakes it up
  Wire.write(0);
  Wire.endTransmission();
}

void loop() {
  static unsigned long last = 0, reported = 0;
  readNmea();
  if (millis() - last >= 50) {
    last += 50;
    readGyro();
    if (haveHeading) steer();
  }
  if (millis() - reported >= 1000) {
    reported += 1000;
    Serial.println(heading * RAD_TO_DEG);
  }
}

float wrapped(float angle) {
  while (angle > PI) angle -= TWO_PI;
  while (angle <= -PI) angle += TWO_PI;
  return angle;
}

void readGyro() {
  Wire.beginTransmission(MPU);
  Wire.write(0x47);  // z axis
  Wire.endTransmission(false);
  if (Wire.requestFrom(MPU, (byte)2) != 2) return;
  byte hi = Wire.read(), lo = Wire.read();
  int raw = (hi << 8) | lo;
  yawRate = raw / 131.0 * DEG_TO_RAD;
}

void readNmea() {
  while (Serial1.available()) {
    char c = Serial1.read();
    if (c == '$') lineLength = 0;
    if (c == '\n') {
      line[lineLength] = 0;
      takeSentence();
      lineLength = 0;
    } else if (lineLength < sizeof(line) - 1) {
      line[lineLength++] = c;
    }
  }
}

// $HEHDT,123.4,T*hh
void takeSentence() {
  byte sum = 0, at = 1;
  while (line[at] && line[at] != '*') sum ^= line[at++];
  if (line[0] != '$' || line[at] != '*' || strtol(line + at + 1, NULL, 16) != sum) return;
  if (strncmp(line + 3, "HDT,", 4) != 0) return;
  heading = wrapped(atof(line + 7) * DEG_TO_RAD);
  haveHeading = true;
}

void steer() {
  float moment = GAIN * wrapped(WANTED - heading) - DAMPING * yawRate;
  moment = constrain(moment, -LIMIT, LIMIT);
  drive(port, SURGE / 2 + moment / (2 * ARM));
  drive(starboard, SURGE / 2 - moment / (2 * ARM));
}

// A T200's pulse for a thrust, N: its thrust grows with the square of the pulse beyond the dead band.
void drive(Servo &thruster, float thrust) {
  float away = 0;
  if (abs(thrust) > 0.2) {
    away = thrust > 0 ? 25 + 375 * sqrt(thrust / 51.0) : -25 - 375 * sqrt(-thrust / 40.0);
  }
  thruster.writeMicroseconds(1500 + (int)constrain(away, -400.0, 400.0));
}
