// Heading and sail autopilot of the sailing robot Gloria, for an Arduino Mega.
//
// GPS and compass:  NMEA 0183 on Serial1, RMC and HDT
// gyroscope:        MPU-6050 on I2C, x to the bow, y to starboard, z down
// wind:             vane on A0 (5 V a turn), cups on pin 2 (1 pulse a second per m/s)
// servos:           rudder 9, flap 10, sail 11
// radio:            commands and telemetry on Serial2; telemetry to the Uno on Serial3
//
// Commands: "H 90" holds a heading, "A" sails round the marks, "S" lets the sail out and stops.
//
// Compiled with -DTWO_BOARDS: the sail has a stepper motor (step 22, direction 23), the marks come from
// the shore by the Uno, and so does what its camera sees.

#include <Servo.h>
#include <Wire.h>

const byte MPU = 0x68;
const byte CUPS_PIN = 2, RUDDER_PIN = 9, FLAP_PIN = 10, SAIL_PIN = 11;
const unsigned long CONTROL_MS = 50, TELEMETRY_MS = 500;

// Where the marks are counted from, 1e-7 degrees, and the marks: m north and east of it; the side on
// which one is left, 1 to port, -1 to starboard, 0 on any; how near it is passed, m.
const long HOME_LAT = -228620000L, HOME_LON = -432230000L;
struct Mark { float north, east; int8_t side; float radius; };
const byte MOST_MARKS = 8;
#ifdef TWO_BOARDS
Mark marks[MOST_MARKS];
byte markCount = 0;
#else
Mark marks[MOST_MARKS] = {{-34.7, 197.0, 0, 8.0}, {-20.0, 0.0, 0, 8.0}, {60.0, 60.0, 0, 8.0}};
byte markCount = 3;
#endif

// PID of the heading: N.m per rad, rad.s and rad/s.
const float KP = 40.0, KI = 2.3, KD = 100.0, INTEGRAL_LIMIT = 3.0;
const float RUDDER_LIMIT = 12.0 * DEG_TO_RAD;
const float TURN_RATE = 6.0 * DEG_TO_RAD;
#ifdef TWO_BOARDS
const bool LIES_TO = true;  // without a mark to go to
#else
const bool LIES_TO = false;
#endif

Servo rudderServo, flapServo, sailServo;

enum Mode { STOPPED, HEADING, MARKED };
Mode mode = MARKED;

float heading = 0, headingWanted = 0, headingTarget = 0, integral = 0;
float speedOver = 0, courseOver = 0, north = 0, east = 0;
float windSpeed = 0, windAngle = PI;      // apparent; where it blows to from the bow
float windNorth = 0, windEast = 0;        // true; where it blows to
float yawRate = 0, rollRate = 0, heel = 0, rudder = 0, sail = 0;
bool haveHeading = false, haveFix = false, haveWind = false, saturated = false;
byte mark = 0;
int nmeaBad = 0;
volatile unsigned int cupPulses = 0;

void setup() {
  Serial.begin(115200);
  Serial1.begin(38400);
  Serial2.begin(57600);
#ifdef TWO_BOARDS
  Serial3.begin(9600);
  beginSail();
#else
  Serial3.begin(19200);
#endif
  rudderServo.attach(RUDDER_PIN);
  flapServo.attach(FLAP_PIN);
  sailServo.attach(SAIL_PIN);
  rudderServo.writeMicroseconds(1500);
  flapServo.writeMicroseconds(1500);
  sailServo.writeMicroseconds(1750);
  pinMode(CUPS_PIN, INPUT_PULLUP);
  attachInterrupt(digitalPinToInterrupt(CUPS_PIN), cupTurned, FALLING);
  Wire.begin();
  Wire.setClock(400000);
  writeRegister(0x6B, 0x00);  // wake up
  writeRegister(0x1B, 0x00);  // 250 deg/s
  writeRegister(0x1C, 0x00);  // 2 g
  Serial.println(F("gloria autopilot"));
}

void loop() {
  static unsigned long controlled = 0, reported = 0;
  readNmea();
  readRadio();
#ifdef TWO_BOARDS
  readShore();
  turnSail();
#endif
  if (millis() - controlled >= CONTROL_MS) {
    controlled += CONTROL_MS;
    readMotion();
    readWind();
    navigate();
    steer();
    trim();
  }
  if (millis() - reported >= TELEMETRY_MS) {
    reported += TELEMETRY_MS;
    report(Serial2);
#ifdef TWO_BOARDS
    reportToShore();
#else
    report(Serial3);
#endif
  }
}

void cupTurned() { cupPulses++; }

float wrapped(float angle) {
  while (angle > PI) angle -= TWO_PI;
  while (angle <= -PI) angle += TWO_PI;
  return angle;
}

// ---------------------------------------------------------------- sensors

void writeRegister(byte address, byte value) {
  Wire.beginTransmission(MPU);
  Wire.write(address);
  Wire.write(value);
  Wire.endTransmission();
}

int readInt() {
  byte hi = Wire.read();
  byte lo = Wire.read();
  return (hi << 8) | lo;
}

void readMotion() {
  Wire.beginTransmission(MPU);
  Wire.write(0x3B);
  Wire.endTransmission(false);
  if (Wire.requestFrom(MPU, (byte)14) != 14) return;
  readInt();
  int ay = readInt(), az = readInt();
  readInt();
  rollRate = readInt() / 131.0 * DEG_TO_RAD;
  readInt();
  yawRate = readInt() / 131.0 * DEG_TO_RAD;
  heel += rollRate * CONTROL_MS / 1000.0;  // what the accelerometer says is right only slowly
  heel += 0.02 * (atan2(-(float)ay, -(float)az) - heel);
}

void readWind() {
  static unsigned long counted = 0;
  windAngle = wrapped(analogRead(A0) * (TWO_PI / 1024.0) - PI);
  if (millis() - counted >= 1000) {
    noInterrupts();
    unsigned int pulses = cupPulses;
    cupPulses = 0;
    interrupts();
    windSpeed = pulses * 1000.0 / (millis() - counted);
    counted = millis();
    haveWind = true;
  }
  if (!haveWind) return;
  float ahead = windSpeed * cos(windAngle), across = windSpeed * sin(windAngle);
  float c = cos(heading), s = sin(heading);
  float n = c * ahead - s * across + speedOver * cos(courseOver);
  float e = s * ahead + c * across + speedOver * sin(courseOver);
  windNorth += 0.0125 * (n - windNorth);  // 4 s
  windEast += 0.0125 * (e - windEast);
}

// ---------------------------------------------------------------- NMEA 0183

char line[84];
byte lineLength = 0;

void readNmea() {
  while (Serial1.available()) {
    char c = Serial1.read();
    if (c == '$') lineLength = 0;
    if (c == '\n') {
      line[lineLength] = 0;
      if (checksumFits()) {
        takeSentence();
      } else {
        nmeaBad++;
      }
      lineLength = 0;
    } else if (lineLength < sizeof(line) - 1) {
      line[lineLength++] = c;
    }
  }
}

bool checksumFits() {
  byte sum = 0, at = 1;
  while (line[at] && line[at] != '*') sum ^= line[at++];
  return line[0] == '$' && line[at] == '*' && strtol(line + at + 1, NULL, 16) == sum;
}

// Field n of the sentence, 0 being its name.
char *field(byte n) {
  char *at = line;
  while (n > 0 && *at) {
    if (*at++ == ',') n--;
  }
  return at;
}

// ddmm.mmmm as 1e-7 degrees: a float has too few digits.
long angleOf(const char *text) {
  long whole = atol(text);
  long degrees = whole / 100;
  long minutes = (whole % 100) * 100000L;
  const char *dot = strchr(text, '.');
  long scale = 10000;
  while (dot && isDigit(*++dot) && scale > 0) {
    minutes += (*dot - '0') * scale;
    scale /= 10;
  }
  return degrees * 10000000L + minutes * 5 / 3;
}

void takeSentence() {
  if (strncmp(line + 3, "HDT", 3) == 0 && *field(1) != ',') {
    heading = wrapped(atof(field(1)) * DEG_TO_RAD);
    if (!haveHeading) headingWanted = heading;
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

// ---------------------------------------------------------------- radio

void readRadio() {
  static char command[16];
  static byte length = 0;
  while (Serial2.available()) {
    char c = Serial2.read();
    if (c == '\n' || c == '\r') {
      command[length] = 0;
      if (length) obey(command);
      length = 0;
    } else if (length < sizeof(command) - 1) {
      command[length++] = c;
    }
  }
}

void obey(const char *command) {
  if (command[0] == 'H') {
    headingTarget = wrapped(atof(command + 1) * DEG_TO_RAD);
    mode = HEADING;
  } else if (command[0] == 'A') {
    mode = MARKED;
  } else if (command[0] == 'S') {
    mode = STOPPED;
  }
}

void report(Print &to) {
  to.print(F("$GLO,"));
  to.print(millis());
  to.print(',');
  to.print(heading * RAD_TO_DEG, 1);
  to.print(',');
  to.print(headingWanted * RAD_TO_DEG, 1);
  to.print(',');
  to.print(north, 1);
  to.print(',');
  to.print(east, 1);
  to.print(',');
  to.print(yawRate * RAD_TO_DEG, 1);
  to.print(',');
  to.print(mark);
  to.print(',');
  to.println(nmeaBad);
}

// ---------------------------------------------------------------- marks

float north2(byte i) { return marks[i].north - north; }
float east2(byte i) { return marks[i].east - east; }

// A mark with a side is passed tangent to a circle about it, or, within that, along it.
float towards(byte i) {
  float n = north2(i), e = east2(i), distance = sqrt(n * n + e * e);
  float aside = distance > marks[i].radius ? asin(marks[i].radius / distance) : HALF_PI;
  return wrapped(atan2(e, n) + marks[i].side * aside);
}

// One on any side is passed within its radius. Another when it was near and lies abeam or behind on the
// way to the next, which leaves it on its side; the last one, when it is abeam.
bool isPassed(byte i) {
  static byte near = 255;  // the mark that was
  float n = north2(i), e = east2(i), radius = marks[i].radius;
  float squared = n * n + e * e;
  if (!marks[i].side) return squared < radius * radius;
  if (squared < 4.0 * radius * radius) near = i;
  if (near != i) return false;
  float course = i + 1 < markCount ? atan2(east2(i + 1), north2(i + 1)) : heading;
  float ahead = n * cos(course) + e * sin(course), starboard = e * cos(course) - n * sin(course);
  bool passed = ahead < 0.5 * radius && starboard * marks[i].side < -0.5 * radius;
  if (passed) near = 255;
  return passed;
}

// ---------------------------------------------------------------- control

void navigate() {
  if (mode == MARKED && haveFix && mark < markCount) {  // after the last one she sails on
    if (isPassed(mark)) {
      mark++;
    } else {
      headingTarget = towards(mark);
    }
  }
#ifdef TWO_BOARDS
  float target = clearOfObstacle(headingTarget);
#else
  float target = headingTarget;
#endif
  // The heading wanted turns at a steady rate, and never through the eye of the wind.
  float turn = wrapped(target - headingWanted);
  float eye = wrapped(atan2(-windEast, -windNorth) - headingWanted);
  bool through = haveWind && turn * eye > 0 && abs(eye) < abs(turn);
  float step = TURN_RATE * CONTROL_MS / 1000.0;
  if (through) {
    headingWanted = wrapped(headingWanted + (turn > 0 ? -step : step));
  } else {
    headingWanted = wrapped(headingWanted + constrain(turn, -step, step));
  }
}

void steer() {
  if (!haveHeading) return;
  float error = wrapped(headingWanted - heading);
  if (!saturated) {
    integral = constrain(integral + KI * error * CONTROL_MS / 1000.0, -INTEGRAL_LIMIT, INTEGRAL_LIMIT);
  }
  float moment = KP * error + integral - KD * yawRate;
  // Lift of a thin foil of 0.00792 m2, 0.562 m aft, in the water's flow.
  float speed = max(speedOver, 0.3);
  float wanted = -moment / (0.562 * 1000.0 * 0.00792 * PI * speed * speed);
  rudder = constrain(wanted, -RUDDER_LIMIT, RUDDER_LIMIT);
  saturated = rudder != wanted;
  rudderServo.writeMicroseconds(1500 + (int)round(rudder * (67.0 / RUDDER_LIMIT)));
}

// The sail's angle for a course so far from dead downwind: those of the source's runs with fixed
// sails, straight lines in between.
float sailFor(float away) {
  static const float AWAY[] = {0, 30, 90, 135, 180}, SAIL[] = {90, 60, 55, 40, 40};
  float degreesAway = away * RAD_TO_DEG;
  int i = 1;
  while (i < 4 && degreesAway > AWAY[i]) i++;
  float share = (degreesAway - AWAY[i - 1]) / (AWAY[i] - AWAY[i - 1]);
  return (SAIL[i - 1] + share * (SAIL[i] - SAIL[i - 1])) * DEG_TO_RAD;
}

void trim() {
  static int side = 1;
  if (mode == STOPPED || !haveWind || !haveHeading || (mode == MARKED && mark >= markCount && LIES_TO)) {
    sail = 90.0 * DEG_TO_RAD;
  } else {
    float away = wrapped(heading - atan2(windEast, windNorth));  // from dead downwind
    if (abs(away) > 5.0 * DEG_TO_RAD) side = away > 0 ? 1 : -1;
    sail = sailFor(abs(away));
    float lee = abs(heel + rollRate) - 28.0 * DEG_TO_RAD;  // a second ahead
    if (lee > 0) sail = constrain(sail + lee, 0.0, HALF_PI);
  }
#ifdef TWO_BOARDS
  aimSail(side * sail);
#else
  sailServo.writeMicroseconds(1500 + (int)round(side * sail * (500.0 / PI)));
#endif
  flapServo.writeMicroseconds(1500);
}
