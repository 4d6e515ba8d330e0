// The VideoRay Pro 4's serial protocol, as far as its topside uses it: detection, configuration, a read
// of the memory, the command block, the replies 1 to 5.
//
// request:  FA AF id flags address length, XOR of these, payload, XOR of all
// answer:   FD DF, then alike; its payload begins with the type of device
// a length of 255: two bytes of length and their XOR follow the first XOR

const byte NODE = 1, BROADCAST = 0xFF, DEVICE = 1, LONGEST = 32;
const byte READ = 0x80, CONFIGURATION = 0xF7, COMMANDS = 15;
const unsigned long GAP_MS = 50;
const byte HUMIDITY = 0x84, POWER = 0x5F, MAGNETOMETER = 0xC4;
const byte BOARDS = 8, NAME_LENGTH = 32;
const char SERIAL_NUMBER[] PROGMEM = "ARDUINO-ROV";

byte request[LONGEST + 8];
byte got = 0;
byte sum = 0;

void readRequests() {
  static unsigned long last = 0;
  if (got && millis() - last > GAP_MS) got = 0;  // broken off
  while (Serial.available()) {
    last = millis();
    request[got++] = Serial.read();
    while (got && !fits()) forget(1);
    while (got >= 8 && got >= request[5] + 8) {
      serve();
      forget(request[5] + 8);
      while (got && !fits()) forget(1);
    }
  }
}

void forget(byte count) {
  got -= count;
  memmove(request, request + count, got);
}

byte xorOf(byte count) {
  byte result = 0;
  for (byte i = 0; i < count; i++) result ^= request[i];
  return result;
}

// Whether what has come so far may be a request.
bool fits() {
  if (request[0] != 0xFA || (got > 1 && request[1] != 0xAF)) return false;
  if (got < 7) return true;
  if (request[5] > LONGEST || xorOf(6) != request[6]) return false;
  byte end = request[5] + 7;
  return got <= end || xorOf(end) == request[end];
}

void serve() {
  byte id = request[2], flags = request[3], address = request[4], length = request[5];
  if (id != NODE && id != BROADCAST) return;
  if (address == 0 && length >= COMMANDS) {
    memcpy(registers, request + 7, COMMANDS);
    obey();
  }
  if (id == BROADCAST || flags == 0) return;
  if (flags & READ) {
    answerRead(address, flags & 0x7F);
  } else if (flags <= 5) {
    answer(flags);
  }
}

// ---------------------------------------------------------------- answers

void send(byte value) {
  Serial.write(value);
  sum ^= value;
}

void begin(byte flags, byte address, byte length) {
  sum = 0;
  send(0xFD);
  send(0xDF);
  send(NODE);
  send(flags);
  send(address);
  send(length);
  send(sum);  // and it is 0 again
}

void sayRegisters(byte address, byte count) {
  for (byte i = 0; i < count; i++) send(registers[address + i]);
}

// What all answers have: heading, pitch, roll, pressure.
void sayAttitude() {
  sayRegisters(HEADING, 6);
  sayRegisters(PRESSURE_MBAR, 2);
}

void answer(byte number) {
  static const byte LENGTHS[] = {0, 9, 9, 11, 13, 34};
  begin(number, 0, LENGTHS[number]);
  send(DEVICE);
  sayAttitude();
  if (number == 3 || number == 4) sayRegisters(WATER, 2);
  if (number == 4) sayRegisters(HUMIDITY, 2);
  if (number == 5) {
    sayRegisters(TURN, 12);
    sayRegisters(MAGNETOMETER, 6);
    send(0);  // status of the attitude
    send(0);
    sayRegisters(HUMIDITY, 2);
    sayRegisters(WATER, 2);
    sayRegisters(POWER, 1);
  }
  send(sum);
}

// Without a count: all from the address on.
void answerRead(byte address, byte count) {
  if (address == CONFIGURATION) {
    answerConfiguration();
    return;
  }
  if (address >= sizeof(registers)) return;
  byte most = sizeof(registers) - address;
  if (count == 0 || count > most) count = most;
  begin(READ, address, count + 1);
  send(DEVICE);
  sayRegisters(address, count);
  send(sum);
}

void sayText(const char *text, byte length) {
  bool ended = false;
  for (byte i = 0; i < length; i++) {
    byte c = ended ? 0 : pgm_read_byte(text + i);
    ended = ended || c == 0;
    send(c);
  }
}

void sayInt(unsigned int value) {
  send(value & 0xFF);
  send(value >> 8);
}

// Of the bootloader, 32 bytes, and of the hardware: a version and the boards' names.
void answerConfiguration() {
  begin(READ, CONFIGURATION, 0xFF);
  sayInt(1 + 32 + 4 + BOARDS * NAME_LENGTH);
  send(sum);
  send(DEVICE);
  sayInt(1);
  sayInt(DEVICE);
  sayText(SERIAL_NUMBER, 16);
  for (byte i = 0; i < 8; i++) send(0);
  send(0x60);  // the firmware is valid
  send(0x0D);
  send(0xF0);
  send(0x0D);
  sayInt(1);
  sayInt(0);
  for (byte i = 0; i < BOARDS; i++) sayText(PSTR("Arduino Mega"), NAME_LENGTH);
  send(sum);
}
