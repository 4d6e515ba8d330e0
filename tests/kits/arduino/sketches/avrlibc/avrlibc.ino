// What sketches take from avr-libc, and corners of the API: all back ends are to print the same.
#include <EEPROM.h>
#include <SPI.h>
#include <Wire.h>
#include <stdarg.h>
#include <util/crc16.h>
#include <util/delay.h>

#define TRACE(x) do { Serial.print(F(#x "=")); Serial.println(x); } while (0)

const char FORMAT[] PROGMEM = "%d,%d";
char buffer[64];
int events = 0;

int ascending(const void *a, const void *b) { return *(const int *)a - *(const int *)b; }

void tell(const char *format, ...) {
  va_list values;
  va_start(values, format);
  vsnprintf(buffer, sizeof(buffer), format, values);
  va_end(values);
  Serial.println(buffer);
}

long added(int count, ...) {
  long sum = 0;
  va_list values;
  va_start(values, count);
  while (count--) sum += va_arg(values, int);
  va_end(values);
  return sum;
}

double mean(int count, ...) {
  double sum = 0;
  va_list values;
  va_start(values, count);
  for (int i = 0; i < count; i++) sum += va_arg(values, double);
  va_end(values);
  return sum / count;
}

void scan() {
  int a = -1, b = -1, guard = 77;
  unsigned int u = 0;
  long l = 0;
  byte small = 0;
  char c = 0, word_[12];
  TRACE(sscanf("12,-34", "%d,%d", &a, &b)); TRACE(a); TRACE(b); TRACE(guard);
  TRACE(sscanf("70000 60000 ff", "%ld %u %x", &l, &u, &a)); TRACE(l); TRACE(u); TRACE(a);
  TRACE(sscanf("$HDT,200,T", "$%3s,%hhu,%c", word_, &small, &c)); TRACE(word_); TRACE(small); TRACE(c);
  TRACE(sscanf("abc", "%d", &a)); TRACE(a);
  TRACE(sscanf("5 6", "%*d %d", &a)); TRACE(a);
  TRACE(sscanf_P("8,9", FORMAT, &a, &b)); TRACE(b);
  TRACE(sscanf("k=17;", "k=%[0-9];", word_)); TRACE(word_);
  TRACE(sscanf("0x1F 017", "%i %i", &a, &b)); TRACE(a); TRACE(b);
  TRACE(sscanf("", "%d", &a));
  double d = 9.0;
  a = b = 5;
  TRACE(sscanf("7 1.5 3", "%d %lf %d", &a, &d, &b)); TRACE(a); TRACE(b); TRACE(d);
}

void strings() {
  char small[6];
  TRACE(strlcpy(small, "northwest", sizeof(small))); TRACE(small);
  small[2] = 0;
  TRACE(strlcat(small, "utical", sizeof(small))); TRACE(small);
  strcpy(buffer, "Wind 12");
  TRACE(strupr(buffer)); TRACE(strlwr(buffer)); TRACE(strrev(buffer));
  TRACE(strcasecmp("GpGga", "gpgga")); TRACE(strncasecmp("GPrmc", "gpgga", 2));
  char list[] = "a,,b", *rest = list, *one;
  while ((one = strsep(&rest, ","))) { Serial.print('['); Serial.print(one); Serial.print(']'); }
  char more[] = "x y z", *state;
  for (one = strtok_r(more, " ", &state); one; one = strtok_r(NULL, " ", &state)) Serial.print(one);
  Serial.println();
  TRACE(strspn("123abc", "0123456789")); TRACE(strcspn("abc,def", ",")); TRACE(strpbrk("heading:90", ":="));
  tell("%d %u %x %ld %s %c %%", -3, 60000u, 0xBEEF, -70000L, "text", 'q');
  tell("%+d % d %-6d| %06d %#x %o", 5, 5, 5, -5, 255, 8);
  TRACE(strcmp_P("8", FORMAT) < 0); TRACE(strncmp_P("%d!", FORMAT, 2));
  TRACE(strtod("2.5e2xyz", &one)); TRACE(one); TRACE(strtol("0x7fff", NULL, 0)); TRACE(strtol("-1011", NULL, 2));
  TRACE(dtostre(1234.5, buffer, 3, 0)); TRACE(dtostre(-0.00123456, buffer, 7, DTOSTR_UPPERCASE)); TRACE(dtostre(5, buffer, 0, DTOSTR_PLUS_SIGN));
  const float shown[] = {0.125, 2.5, 0.5, 123456.789, 3.14159265, 1e-5, 1e10, 16777217.0, -0.0049, 99.9951, 0.0, NAN, INFINITY, -INFINITY};
  for (float each : shown) for (byte digits = 0; digits < 9; digits += 2) { Serial.print(dtostrf(each, -10, digits, buffer)); Serial.print('|'); }
  Serial.println();
}

void numbers() {
  int values[] = {300, -5, 12000, 7, -3200, 0}, wanted = 12000;
  qsort(values, 6, sizeof(int), ascending);
  for (int v : values) { Serial.print(v); Serial.print(' '); }
  int *found = (int *)bsearch(&wanted, values, 6, sizeof(int), ascending);
  TRACE(found - values);
  div_t d = div(-7, 2); TRACE(d.quot); TRACE(d.rem);
  ldiv_t e = ldiv(100000L, 7); TRACE(e.quot); TRACE(e.rem);
  Serial.println(labs(-70000L)); TRACE(added(3, 1, -2, 3000)); TRACE(mean(2, 1.0, 2.5));
  int exponent; double whole;
  TRACE(frexp(12.0, &exponent)); TRACE(exponent); TRACE(modf(-3.25, &whole)); TRACE(whole); TRACE(ldexp(1.5, 4));
  TRACE(square(1.5)); TRACE(lrint(2.5)); TRACE(fmax(1, 2) + fmin(1, 2)); TRACE(copysign(3.0, -1.0)); TRACE(isinf(INFINITY) != 0);
  TRACE(rand()); TRACE(rand()); srand(7); TRACE(rand() % 100); TRACE(RAND_MAX); TRACE(random()); 
  uint16_t crc = 0xFFFF;
  for (char c : "123456789") if (c) crc = _crc_ccitt_update(crc, c);
  TRACE(crc);
  for (byte i = 0; i < 9; i++) crc = _crc16_update(crc, i);
  TRACE(crc); TRACE(_crc_xmodem_update(0x1234, 0x56)); TRACE(_crc_ibutton_update(0x12, 0x34)); TRACE(_crc8_ccitt_update(0x12, 0x34));
  TRACE(clockCyclesToMicroseconds(3200)); TRACE(microsecondsToClockCycles(5)); TRACE(M_PI); TRACE(makeWord(1, 2));
  Serial.println(B101); TRACE(0b1101); TRACE(bit(17)); TRACE(makeWord(0xABCD));
}

void characters() {
  unsigned long sums[16] = {};
  for (int c = 0; c < 128; c++) {
    bool is[] = {isAlphaNumeric(c), isAlpha(c), isAscii(c), isWhitespace(c), isControl(c), isDigit(c), isGraph(c), isLowerCase(c),
                 isPrintable(c), isPunct(c), isSpace(c), isUpperCase(c), isHexadecimalDigit(c)};
    for (byte i = 0; i < sizeof(is); i++) if (is[i]) sums[i] += (c + 1) * (c + 3L);
  }
  for (unsigned long each : sums) { Serial.print(each); Serial.print(' '); }
  Serial.println();
  TRACE(toAscii(0xC1)); TRACE((char)toLowerCase('A')); TRACE((char)toUpperCase('z')); TRACE(isAscii(200));
}

void parts() {
  SPI.begin(); SPI.setClockDivider(SPI_CLOCK_DIV16); SPI.setBitOrder(LSBFIRST); SPI.setDataMode(SPI_MODE2); SPI.end();
  Wire.begin(); Wire.setClock(400000L); Wire.setWireTimeout(3000, true);
  TRACE(Wire.getWireTimeoutFlag()); Wire.clearWireTimeoutFlag();
  unsigned long sum = 0;
  for (int i = 0; i < 5; i++) EEPROM.write(i, i * 50);
  for (auto each : EEPROM) sum += each;
  TRACE(sum);
  unsigned long then = millis();
  _delay_ms(20); _delay_us(500);
  then = millis() - then;
  TRACE(then >= 20 && then < 23);
  TRACE(SERIAL_RX_BUFFER_SIZE); TRACE(Serial.getWriteError()); TRACE(Serial.getTimeout());
}

int put_on_serial(char c, FILE *) { Serial.write(c); return 0; }

void setup() {
  Serial.begin(57600, SERIAL_8N1);
  printf("nowhere");
  fdevopen(put_on_serial, 0);
  printf_P(PSTR("%d %s\r\n"), printf("%u|%ld\r\n", 65535u, -70000L), "chars");
  scan();
  strings();
  numbers();
  characters();
  parts();
  Serial.setTimeout(1000);
  TRACE(Serial.findUntil("$H", "*"));
  TRACE(Serial.parseInt());
  TRACE(Serial.parseInt(SKIP_WHITESPACE));
  TRACE(Serial.parseFloat(SKIP_NONE));
  TRACE((char)Serial.read());
  TRACE(Serial.parseFloat(SKIP_ALL, ','));
  TRACE(Serial.find('a'));
  TRACE(Serial.findUntil("bbd", "*"));
  TRACE(Serial.findUntil("never", "*"));
  TRACE(Serial.readStringUntil(';'));
}

void serialEvent() {
  while (Serial.available()) {
    char c = Serial.read();
    events++;
    if (c == 'q') { Serial.print(F("events ")); Serial.println(events); }
  }
}

void loop() {}
