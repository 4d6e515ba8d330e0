// Controller of a small ROV with three thrusters, for an Arduino Mega, driven as a VideoRay Pro 4 is.
//
// commands:    the Pro 4's serial protocol on Serial, see pro4.ino. Without a command block for 2 s
//              everything stops.
// depth:       MS5837-30BA, heading: HMC5883L, turn, roll, pitch: MPU-6050, all on I2C, x ahead, z down
// thrusters:   speed controllers, port 5, starboard 6, vertical 7; 1100 to 1900 us, 1500 stops; the
//              vertical one pushes down above 1500

#include <Servo.h>
#include <Wire.h>

const byte MPU = 0x68, COMPASS = 0x1E, PRESSURE = 0x76;
const unsigned long LOST_MS = 2000, CONTROL_MS = 50;
const float MBAR_PER_M = 98.0665;                             // fresh water
const float DEPTH_KP = 0.8, DEPTH_KI = 0.15, DEPTH_KD = 1.2;  // shares of full thrust
const float YAW_KP = 0.08, YAW_KD = 0.08;
const unsigned int OFF = 0xFFFF;

// Control and status registers, as the protocol has them: addresses of those used here.
const byte PORT_TARGET = 0x00, STARBOARD_TARGET = 0x02, VERTICAL_TARGET = 0x04, DEPTH_TARGET = 0x0B,
           HEADING_TARGET = 0x0D, PRESSURE_MBAR = 0x66, HEADING = 0x68, PITCH = 0x6A, ROLL = 0x6C,
           TURN = 0x6E, FORCE = 0x74, WATER = 0x7A;
byte registers[0xF0];

Servo port, starboard, vertical;
unsigned int calibration[7];
float depth = 0, sinking = 0, heading = 0, yawRate = 0, depthIntegral = 0;
bool armed = false, measured = false;
unsigned long received = 0;
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
  readRequests();
  if (millis() - last >= CONTROL_MS) {
    last += CONTROL_MS;
    readDepth();
    readMotion();
    control();
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
  float mbar = (d1 * (sens / 2097152.0) - off) / 8192.0 / 10.0;
  float now = (mbar - 1013.25) / MBAR_PER_M;
  if (measured) sinking += 0.2 * ((now - depth) / 0.05 - sinking);
  depth = now;
  measured = true;
  put(PRESSURE_MBAR, mbar);
  put(WATER, 2000 + dt * (calibration[6] / 8388608.0));
}

int readInt() {
  byte hi = Wire.read();
  byte lo = Wire.read();
  return (hi << 8) | lo;
}

void readMotion() {
  command(COMPASS, 0x03);
  Wire.requestFrom(COMPASS, (byte)6);
  int x = readInt();
  readInt();
  int y = readInt();
  heading = atan2(-(float)y, (float)x);
  Wire.beginTransmission(MPU);
  Wire.write(0x3B);
  Wire.endTransmission(false);
  Wire.requestFrom(MPU, (byte)14);
  float force[3];
  for (byte i = 0; i < 3; i++) force[i] = readInt() / 16384.0 * 9806.65;  // mm/s2
  readInt();
  float roll = readInt() / 131.0, pitch = readInt() / 131.0, yaw = readInt() / 131.0;
  yawRate = yaw * DEG_TO_RAD;
  put(HEADING, heading * RAD_TO_DEG * 10);
  put(PITCH, atan2(force[0], sqrt(force[1] * force[1] + force[2] * force[2])) * RAD_TO_DEG * 10);
  put(ROLL, atan2(-force[1], -force[2]) * RAD_TO_DEG * 10);
  put(TURN, yaw * DEG_TO_RAD * 1000);
  put(TURN + 2, pitch * DEG_TO_RAD * 1000);
  put(TURN + 4, roll * DEG_TO_RAD * 1000);
  for (byte i = 0; i < 3; i++) put(FORCE + 2 * i, force[i]);
}

// ---------------------------------------------------------------- registers

void put(byte address, float value) {
  int number = round(value);
  registers[address] = number & 0xFF;
  registers[address + 1] = (number >> 8) & 0xFF;
}

int get(byte address) {
  return (registers[address + 1] << 8) | registers[address];
}

// A command block has come.
void obey() {
  received = millis();
  if (!armed) depthIntegral = 0;
  armed = true;
}

// ---------------------------------------------------------------- control

void stopAll() {
  armed = false;
  port.writeMicroseconds(1500);
  starboard.writeMicroseconds(1500);
  vertical.writeMicroseconds(1500);
}

void control() {
  if (!armed || millis() - received > LOST_MS) {
    stopAll();
    return;
  }
  float down = -get(VERTICAL_TARGET) / 100.0;  // the protocol counts it upwards
  unsigned int held = get(DEPTH_TARGET), course = get(HEADING_TARGET);
  if (held != OFF) {
    float error = (held - 1013.25) / MBAR_PER_M - depth;
    down = DEPTH_KP * error + depthIntegral - DEPTH_KD * sinking;
    if (abs(down) < 1.0) depthIntegral += DEPTH_KI * error * CONTROL_MS / 1000.0;
  }
  float turn = 0;
  if (course != OFF) {
    turn = YAW_KP * wrapped(course * DEG_TO_RAD - heading) - YAW_KD * yawRate;
    turn = constrain(turn, -0.3, 0.3);
  }
  drive(vertical, down);
  drive(port, get(PORT_TARGET) / 100.0 + turn);
  drive(starboard, get(STARBOARD_TARGET) / 100.0 - turn);
}

void drive(Servo &thruster, float share) {
  thruster.writeMicroseconds(1500 + (int)(400.0 * constrain(share, -1.0, 1.0)));
}
