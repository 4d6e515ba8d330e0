// Controller of a small ROV with three thrusters, for an Arduino Mega.
//
// commands:    a line each on Serial: "D 2.5" depth in m, "H 90" heading in degrees, "V 20" surge in
//              percent, "X" stop. Without any for 2 s everything stops.
// telemetry:   "$ROV,depth,heading,..." on Serial, ten times a second
// depth:       MS5837-30BA, heading: HMC5883L, turn: MPU-6050, all on I2C, x ahead, z down
// thrusters:   speed controllers, port 5, starboard 6, vertical 7; 1100 to 1900 us, 1500 stops

#include <Servo.h>
#include <Wire.h>

const byte MPU = 0x68, COMPASS = 0x1E, PRESSURE = 0x76;
const unsigned long LOST_MS = 2000;
const float DEPTH_KP = 0.8, DEPTH_KI = 0.15, DEPTH_KD = 1.2;  // shares of full thrust
const float YAW_KP = 0.08, YAW_KD = 0.08;

Servo port, starboard, vertical;
unsigned int calibration[7];
float depth = 0, sinking = 0, heading = 0, yawRate = 0, surge = 0;
float depthWanted = 0, headingWanted = 0, depthIntegral = 0;
bool armed = false, measured = false;
unsigned long heard = 0;
unsigned long temperatureCount = 0;

void setup() {
  Serial.begin(115200);
  port.attach(5);
  starboard.attach(6);
  vertical.attach(7);
  stopAll();
  Wire.begin();
  Wire.setClock(400000);
  writeRegister(MPU, 0x6B, 0);
  writeRegister(COMPASS, 0x00, 0x18);
  writeRegister(COMPASS, 0x02, 0x00);  // continuous
  command(PRESSURE, 0x1E);
  delay(10);
  for (byte i = 0; i < 7; i++) {
    command(PRESSURE, 0xA0 + 2 * i);
    Wire.requestFrom(PRESSURE, (byte)2);
    calibration[i] = (unsigned int)Wire.read() << 8;
    calibration[i] |= Wire.read();
  }
}

void loop() {
  static unsigned long last = 0;
  readCommands();
  if (millis() - last >= 50) {
    last += 50;
    readDepth();
    readMotion();
    control();
    report();
  }
}

float wrapped(float angle) {
  while (angle > PI) angle -= TWO_PI;
  while (angle <= -PI) angle += TWO_PI;
  return angle;
}

// ---------------------------------------------------------------- sensors

void command(byte device, byte what) {
  Wire.beginTransmission(device);
  Wire.write(what);
  Wire.endTransmission();
}

void writeRegister(byte device, byte address, byte value) {
  Wire.beginTransmission(device);
  Wire.write(address);
  Wire.write(value);
  Wire.endTransmission();
}

unsigned long converted(byte what) {
  command(PRESSURE, what);
  delay(3);  // oversampling of 512
  command(PRESSURE, 0x00);
  Wire.requestFrom(PRESSURE, (byte)3);
  unsigned long value = (unsigned long)Wire.read() << 16;
  value |= (unsigned long)Wire.read() << 8;
  return value | Wire.read();
}

// To first order, as the data sheet has it: at 20 degrees there is no more.
void readDepth() {
  static unsigned int turn = 0;
  if (turn++ % 10 == 0) temperatureCount = converted(0x52);
  unsigned long d1 = converted(0x42);
  long dt = (long)temperatureCount - (long)calibration[5] * 256L;
  float off = calibration[2] * 65536.0 + calibration[4] * (dt / 128.0);
  float sens = calibration[1] * 32768.0 + calibration[3] * (dt / 256.0);
  float pascal = (d1 * (sens / 2097152.0) - off) / 8192.0 * 10.0;
  float now = (pascal - 101325.0) / 9806.65;
  if (measured) sinking += 0.2 * ((now - depth) / 0.05 - sinking);
  depth = now;
  measured = true;
}

int readInt() {
  byte hi = Wire.read();
  byte lo = Wire.read();
  return (hi << 8) | lo;
}

void readMotion() {
  Wire.beginTransmission(COMPASS);
  Wire.write(0x03);
  Wire.endTransmission();
  Wire.requestFrom(COMPASS, (byte)6);
  int x = readInt();
  readInt();
  int y = readInt();
  heading = atan2(-(float)y, (float)x);
  Wire.beginTransmission(MPU);
  Wire.write(0x47);
  Wire.endTransmission(false);
  Wire.requestFrom(MPU, (byte)2);
  yawRate = readInt() / 131.0 * DEG_TO_RAD;
}

// ---------------------------------------------------------------- commands

void readCommands() {
  static char line[16];
  static byte length = 0;
  while (Serial.available()) {
    char c = Serial.read();
    if (c == '\n' || c == '\r') {
      line[length] = 0;
      if (length) obey(line);
      length = 0;
    } else if (length < sizeof(line) - 1) {
      line[length++] = c;
    }
  }
}

void obey(const char *line) {
  heard = millis();
  if (line[0] == 'X') {
    armed = false;
    return;
  }
  if (!armed) {
    headingWanted = heading;
    depthWanted = depth;
    depthIntegral = surge = 0;
    armed = true;
  }
  float value = atof(line + 1);
  if (line[0] == 'D') depthWanted = constrain(value, 0.0, 100.0);
  if (line[0] == 'H') headingWanted = wrapped(value * DEG_TO_RAD);
  if (line[0] == 'V') surge = constrain(value, -100.0, 100.0) / 100.0;
}

void report() {
  static byte turn = 0;
  if (++turn % 2) return;
  Serial.print(F("$ROV,"));
  Serial.print(depth);
  Serial.print(',');
  Serial.print(heading * RAD_TO_DEG, 1);
  Serial.print(',');
  Serial.println(armed);
}

// ---------------------------------------------------------------- control

void stopAll() {
  port.writeMicroseconds(1500);
  starboard.writeMicroseconds(1500);
  vertical.writeMicroseconds(1500);
}

void control() {
  if (millis() - heard > LOST_MS) armed = false;
  if (!armed) {
    stopAll();
    return;
  }
  float error = depthWanted - depth;
  float down = DEPTH_KP * error + depthIntegral - DEPTH_KD * sinking;
  if (abs(down) < 1.0) depthIntegral += DEPTH_KI * error * 0.05;
  float turn = YAW_KP * wrapped(headingWanted - heading) - YAW_KD * yawRate;
  turn = constrain(turn, -0.3, 0.3);
  drive(vertical, down);
  drive(port, surge + turn);
  drive(starboard, surge - turn);
}

void drive(Servo &thruster, float share) {
  thruster.writeMicroseconds(1500 + (int)(400.0 * constrain(share, -1.0, 1.0)));
}
