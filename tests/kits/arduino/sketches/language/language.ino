// C++ as sketches use it, in a sketch of several files: all back ends are to print the same.
#include <Wire.h>
#include <EEPROM.h>
#include "helper.h"
#define TRACE(x) do { Serial.print(#x "="); \
  Serial.println(x); } while (0)
struct Point { int x, y; };
union Bits { float f; byte b[4]; uint32_t u; };
struct Flags { uint8_t a : 3; uint8_t b : 5; };
struct Fields { int a : 3; unsigned b : 3; signed int c : 4; char d : 2; long e : 20; };
class Shape { public: virtual float area() = 0; virtual ~Shape() {} };
class Square : public Shape { public: Square(float s) : s_(s) {} float area() override { return s_ * s_; } private: float s_; };
class Upper : public Print { public: size_t write(uint8_t c) override { return Serial.write(toupper(c)); } using Print::write; };
Upper upper;
const char *const words[] = {"zero", "one", "two"};
const int N = sizeof(words) / sizeof(words[0]);
static byte checksum(const char *text, byte start = 0) { while (*text) start ^= *text++; return start; }
Point shifted(Point p, int dx);
int *pointer_to(int &v) { return &v; }
template <typename T, int M> int countOf(T (&)[M]) { return M; }
volatile unsigned long edges = 0;
#define HALVED(TYPE) TYPE halved_##TYPE(TYPE x) { return x / 2; }
HALVED(float)
HALVED(double)
void setup() {
  Serial.begin(57600);
  Point p = shifted({1, 2}, 5); TRACE(p.x);
  later(p);
  TRACE(p.y);
  Bits bits;
  bits.f = -1.5;
  TRACE(bits.b[3]);
  Serial.println(bits.u, HEX);
  Flags flags = {5, 17}; TRACE(flags.a + flags.b); TRACE(sizeof(flags));
  Fields fields = {-1, 7, -3, -1, -5};
  TRACE(fields.a); TRACE(fields.b); TRACE(fields.c); Serial.println((int)fields.d); Serial.println((long)fields.e);
  Square sq2(1.5);
  Shape *shape = &sq2;
  TRACE(shape->area());
  upper.print("upper ");
  upper.println(12.5, 3);
  TRACE(words[2]);
  TRACE(N);
  TRACE(countOf(words));
  TRACE(checksum("GPGGA"));
  int v = 3;
  *pointer_to(v) = 8;
  TRACE(v);
  TRACE(helped(4));
  TRACE(HELP);
  Serial.println(1e20);
  Serial.println(-0.001, 2);
  Serial.println(0.1 + 0.2, 7);
  Serial.println(4294967295UL);
  Serial.println(-2147483647L - 1);
  Serial.println(true);
  Serial.println((char)66);
  Serial.println(NAN);
  Serial.println(INFINITY);
  Serial.println(123.456, 0);
  Serial.println(0.5, 0);
  Serial.println(99.995);
  TRACE(-7 / 2);
  TRACE(-7 % 3);
  TRACE((char)200 < 0);
  TRACE((byte)-1);
  Serial.println((int)3.99);
  Serial.println((int)-3.99);
  Serial.println((unsigned int)-1);
  Serial.println((long)1e6);
  TRACE(0x7FFF);
  TRACE('a' + 1);
  TRACE(10 > 3 ? 1.5 : 2);
  String s = String("a") + F("b") + 'c' + 1.5f + 7u; TRACE(s); s = ""; s += 3.0; s += F("x"); s += 'y'; s += (byte)5; s += -2L; TRACE(s); TRACE(s.length()); String t(s); t.replace("x", "--"); TRACE(t); TRACE(t.indexOf("--", 1)); TRACE(t.equals(s)); TRACE(String(1.23456)); int five = -5; TRACE(String(five, BIN).length()); TRACE(String("  trim ").length()); t = "  trim "; t.trim(); TRACE(t); TRACE(t.equalsIgnoreCase("TRIM")); char buf[10]; t.toCharArray(buf, 3); TRACE(buf); TRACE(t.c_str()[1]); t.toLowerCase(); TRACE(t > "aaa"); TRACE(t.toInt()); byte bytes[4]; t.getBytes(bytes, 4); TRACE(bytes[0]); t.reserve(40); TRACE(t == String("trim")); for (char c : t) Serial.print(c, DEC); Serial.println();
  for (unsigned int i = 3; i < 4; i--) Serial.print(i); Serial.println();
  unsigned long then = micros();
  delayMicroseconds(100);
  TRACE(micros() - then >= 100 && micros() - then < 200);
  uint8_t shift = 0x96;
  shift = shift << 1 | shift >> 7;
  TRACE(shift);
  shift = ~shift;
  TRACE(shift);
  int volatile n16 = -7; n16 += 16;
  Serial.println(halved_float(1.5) + halved_double(3), 3);
  unsigned char uc = 250; uc += 10; TRACE(uc);
  signed char sc = -100; TRACE(sc); Serial.println((char unsigned)300); Serial.println((unsigned /* eight bits */ char)-1);
  long double ld = 1.5; TRACE((float)ld); TRACE(sizeof(ld)); long const lc = 70000; Serial.println(lc); const unsigned us = 65535; Serial.println((unsigned)(us + 1)); unsigned const int uci = 65535; Serial.println(uci); int const volatile *const at = &n16; int seen = *at; TRACE(seen);
  int8_t n = -128;
  n--;
  TRACE(n);
  int a = 200, b = 200;
  int c = a * b;
  TRACE(c);
  unsigned int d = 40000u + 40000u;
  TRACE(d);
  long e = 200L * 200;
  TRACE(e);
  TRACE(Wire.requestFrom(0x10, 2));
  Wire.begin();
  Wire.beginTransmission(0x68);
  TRACE(Wire.endTransmission() == 0);
  pinMode(7, INPUT_PULLUP); TRACE(digitalRead(7)); pinMode(8, OUTPUT); digitalWrite(8, HIGH); TRACE(digitalRead(8)); analogWrite(9, 128); pinMode(2, INPUT); attachInterrupt(digitalPinToInterrupt(2), []() { edges++; }, CHANGE); detachInterrupt(digitalPinToInterrupt(2));
  Serial.flush();
  Serial.setTimeout(200);
  Serial.println(Serial.find("$"));
  Serial.println(Serial.parseFloat(), 3);
  Serial.println(Serial.read());
  Serial.println(Serial.parseInt());
  char got[8];
  int k = Serial.readBytesUntil('*', got, 7);
  got[k] = 0;
  TRACE(got);
  Serial.println(Serial.peek());
  Serial.println(Serial.readStringUntil('\n'));
  k = Serial.readBytes(got, 3);
  TRACE(k);
  Serial.println(Serial.available());
}
Point shifted(Point p, int dx) { p.x += dx; return p; }
void later(Point &p) { p.y = 77; }
void loop() {
  static int turns = 0;
  if (turns < 3 && ++turns == 3) Serial.println("third");
}
