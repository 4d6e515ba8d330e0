// Station keeper of the Hydrone catamaran, for an Arduino Mega: two thrusters, no force abeam.
//
// GPS and compass:  NMEA 0183 on Serial1, RMC and HDT
// gyroscope:        MPU-6050 on I2C, z down
// thrusters:        speed controllers, port 9, starboard 10; 1100 to 1900 us, 1500 stops
// telemetry:        Serial
//
// Near the station it holds the heading and works along the bow; further off it points the bow or
// the stern, whichever is nearer, at the station and drives there.

#include <Servo.h>
#include <Wire.h>

const byte MPU = 0x68;
const long HOME_LAT = -317800000L, HOME_LON = -522600000L;  // 1e-7 degrees
const float HOLD_RADIUS = 1.5, CAPTURE_RADIUS = 0.6;          // m
const float SURGE_GAIN = 12.0, SURGE_DAMPING = 25.0, SURGE_LIMIT = 30.0;  // N/m, N.s/m, N
const float YAW_GAIN = 8.0, YAW_DAMPING = 10.0, YAW_LIMIT = 8.0;          // N.m/rad, N.m.s/rad, N.m
const float ARM = 0.3;                                        // m from the middle to a thruster
const float STATION_HEADING = 0.0;

Servo port, starboard;
float heading = 0, yawRate = 0, north = 0, east = 0, speedOver = 0, courseOver = 0;
bool haveFix = false, haveHeading = false, returning = false;
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
  Wire.setClock(400000);
  Wire.beginTransmission(MPU);
  Wire.write(0x6B);
  Wire.write(0);
  Wire.endTransmission();
}

void loop() {
  static unsigned long last = 0, reported = 0;
  readNmea();
  if (millis() - last >= 50) {
    last += 50;
    readGyro();
    keep();
  }
  if (millis() - reported >= 1000) {
    reported += 1000;
    Serial.print(F("$HYD,"));
    Serial.print(north);
    Serial.print(',');
    Serial.print(east);
    Serial.print(',');
    Serial.println(returning);
  }
}

float wrapped(float angle) {
  while (angle > PI) angle -= TWO_PI;
  while (angle <= -PI) angle += TWO_PI;
  return angle;
}

void readGyro() {
  Wire.beginTransmission(MPU);
  Wire.write(0x47);
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

char *field(byte n) {
  char *at = line;
  while (n > 0 && *at) {
    if (*at++ == ',') n--;
  }
  return at;
}

// ddmm.mmmmm as 1e-7 degrees.
long angleOf(const char *text) {
  long whole = atol(text);
  long minutes = (whole % 100) * 100000L;
  const char *dot = strchr(text, '.');
  long scale = 10000;
  while (dot && isDigit(*++dot) && scale > 0) {
    minutes += (*dot - '0') * scale;
    scale /= 10;
  }
  return whole / 100 * 10000000L + minutes * 5 / 3;
}

void takeSentence() {
  byte sum = 0, at = 1;
  while (line[at] && line[at] != '*') sum ^= line[at++];
  if (line[0] != '$' || line[at] != '*' || strtol(line + at + 1, NULL, 16) != sum) return;
  if (strncmp(line + 3, "HDT", 3) == 0) {
    heading = wrapped(atof(field(1)) * DEG_TO_RAD);
    haveHeading = true;
  } else if (strncmp(line + 3, "RMC", 3) == 0 && *field(2) == 'A') {
    long lat = angleOf(field(3)), lon = angleOf(field(5));
    if (*field(4) == 'S') lat = -lat;
    if (*field(6) == 'W') lon = -lon;
    north = (lat - HOME_LAT) * 0.0111319;
    east = (lon - HOME_LON) * 0.0111319 * cos(HOME_LAT * 1e-7 * DEG_TO_RAD);
    speedOver = atof(field(7)) * 0.514444;
    courseOver = atof(field(8)) * DEG_TO_RAD;
    haveFix = true;
  }
}

void keep() {
  if (!haveFix || !haveHeading) return;
  float distance = sqrt(north * north + east * east);
  if (distance > HOLD_RADIUS) returning = true;
  if (distance < CAPTURE_RADIUS) returning = false;
  float along = -(north * cos(heading) + east * sin(heading));  // to the station, along the bow
  float wanted = STATION_HEADING;
  if (returning) {
    wanted = atan2(-east, -north);
    if (along < 0) wanted += PI;
  }
  float error = wrapped(wanted - heading);
  float ahead = speedOver * cos(courseOver - heading);
  float surge = SURGE_GAIN * along * (returning ? max(0.0, cos(error)) : 1.0) - SURGE_DAMPING * ahead;
  surge = constrain(surge, -SURGE_LIMIT, SURGE_LIMIT);
  float moment = constrain(YAW_GAIN * error - YAW_DAMPING * yawRate, -YAW_LIMIT, YAW_LIMIT);
  drive(port, surge / 2 + moment / (2 * ARM));
  drive(starboard, surge / 2 - moment / (2 * ARM));
}

// A T200's pulse for a thrust, N: its thrust grows with the square of the pulse beyond the dead band.
void drive(Servo &thruster, float thrust) {
  float away = 0;
  if (abs(thrust) > 0.2) {
    away = thrust > 0 ? 25 + 375 * sqrt(thrust / 51.0) : -25 - 375 * sqrt(-thrust / 40.0);
  }
  thruster.writeMicroseconds(1500 + (int)constrain(away, -400.0, 400.0));
}
