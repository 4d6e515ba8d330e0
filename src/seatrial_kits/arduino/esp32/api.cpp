/* Arduino-ESP32's functions in terms of the machine; costs are in its units of 62.5 ns, roughly a board's. */
#include "Arduino.h"
#include "machine.h"
#include "soc/gpio_struct.h"

using machine::charge;

/* ------------------------------------------------------------------ time */

constexpr uint64_t US = 16, MS = 16000;

unsigned long micros() { charge(2); return (unsigned long)(machine::now / US); }
unsigned long millis() { charge(2); return (unsigned long)(machine::now / MS); }
int64_t esp_timer_get_time() { charge(2); return (int64_t)(machine::now / US); }
void delay(uint32_t ms) { vTaskDelay(ms); }
void delayMicroseconds(uint32_t us) { charge(4); machine::pass_until(machine::now + us * US); }
void yield() { charge(4); taskYIELD(); }
uint32_t EspClass::getCycleCount() { charge(1); return (uint32_t)(machine::now * 15); }

/* ------------------------------------------------------------------ pins */

void pinMode(uint8_t pin, uint8_t mode)
{
    charge(16);
    bool output = (mode & OUTPUT) == OUTPUT;
    machine::direct(pin, output);
    if (!output)
        machine::drive(pin, mode & PULLUP);
}

void digitalWrite(uint8_t pin, uint8_t level) { charge(2); machine::drive(pin, level != LOW); }
int digitalRead(uint8_t pin) { charge(2); return machine::level(pin); }

volatile uint32_t *portInputRegister(uint8_t port) { return (volatile uint32_t *)machine::register_of((uint8_t)(port - 1), 0); }
volatile uint32_t *portModeRegister(uint8_t port) { return (volatile uint32_t *)machine::register_of((uint8_t)(port - 1), 1); }
volatile uint32_t *portOutputRegister(uint8_t port) { return (volatile uint32_t *)machine::register_of((uint8_t)(port - 1), 2); }

static int adc_bits = 12;
static double full[board::PINS]; /* V; 0: not set */
static double full_of_all = 3.3;

static double full_scale(adc_attenuation_t attenuation)
{
    const double volts[] = {1.1, 1.5, 2.2, 3.3};
    return volts[attenuation < ADC_ATTENDB_MAX ? attenuation : ADC_11db];
}

void analogReadResolution(uint8_t bits) { adc_bits = bits; }
void analogSetWidth(uint8_t bits) { adc_bits = bits; }
void analogSetAttenuation(adc_attenuation_t attenuation) { full_of_all = full_scale(attenuation); }
void analogSetPinAttenuation(uint8_t pin, adc_attenuation_t attenuation) { full[pin % board::PINS] = full_scale(attenuation); }

static double read_volts(uint8_t pin, double &most)
{
    charge(960);
    machine::level(pin); /* refuses a pin that there is not */
    most = full[pin] > 0.0 ? full[pin] : full_of_all;
    double volts = machine::volts(pin);
    return volts < 0.0 ? 0.0 : volts > most ? most : volts;
}

uint16_t analogRead(uint8_t pin)
{
    double most, volts = read_volts(pin, most);
    uint16_t count = (uint16_t)(volts / most * 4095.0); /* of 12 bits, shifted to others */
    return (uint16_t)(adc_bits < 12 ? count >> (12 - adc_bits) : count << (adc_bits - 12));
}

uint32_t analogReadMilliVolts(uint8_t pin)
{
    double most;
    return (uint32_t)lround(read_volts(pin, most) * 1000.0);
}

/* ------------------------------------------------------------------ interrupts */

static std::function<void()> handlers[board::PINS];

void attachInterrupt(uint8_t pin, std::function<void()> handler, int mode)
{
    charge(40);
    machine::level(pin);
    handlers[pin] = handler;
    machine::on_edge(pin, [](void *one) { (*(std::function<void()> *)one)(); }, &handlers[pin], mode == CHANGE ? 1 : mode == FALLING ? 2 : 3);
}

void attachInterrupt(uint8_t pin, void (*handler)(), int mode) { attachInterrupt(pin, std::function<void()>(handler), mode); }
void attachInterruptArg(uint8_t pin, void (*handler)(void *), void *argument, int mode) { attachInterrupt(pin, [=] { handler(argument); }, mode); }
void detachInterrupt(uint8_t pin) { charge(40); machine::on_edge(pin, nullptr, nullptr, 0); }
void sei() { machine::enable(true); charge(1); }
void cli() { machine::enable(false); charge(1); }

/* ------------------------------------------------------------------ the chip */

EspClass ESP;

void esp_restart() { machine::restart(); }
uint32_t esp_get_free_heap_size() { return 270000; }
esp_reset_reason_t esp_reset_reason() { return machine::reset_flags == 1 ? ESP_RST_POWERON : ESP_RST_SW; }
uint64_t EspClass::getEfuseMac() { return 0x0100000000A4ull; }

const char *EspClass::getChipModel()
{
#if defined(BOARD_ESP32S3)
    return "ESP32-S3";
#elif defined(BOARD_ESP32C3)
    return "ESP32-C3";
#else
    return "ESP32-D0WDQ6";
#endif
}

uint8_t EspClass::getChipCores()
{
#ifdef BOARD_ESP32C3
    return 1;
#else
    return 2;
#endif
}

esp_err_t esp_efuse_mac_get_default(uint8_t *mac)
{
    for (int each = 0; each < 6; each++)
        mac[each] = (uint8_t)(ESP.getEfuseMac() >> 8 * each);
    return ESP_OK;
}

esp_err_t esp_read_mac(uint8_t *mac, esp_mac_type_t) { return esp_efuse_mac_get_default(mac); }
const char *esp_err_to_name(esp_err_t code) { return code == ESP_OK ? "ESP_OK" : code == ESP_ERR_TIMEOUT ? "ESP_ERR_TIMEOUT" : "ESP_FAIL"; }

void esp_error_check(esp_err_t code, const char *file, int line)
{
    if (code != ESP_OK)
        machine::end("ESP_ERROR_CHECK failed: 0x%x at %s:%d", code, file, line);
}

void sketch_log(char letter, const char *file, int line, const char *function, const char *format, ...)
{
    char text[256];
    va_list values;
    va_start(values, format);
    vsnprintf(text, sizeof text, format, values);
    va_end(values);
    const char *name = strrchr(file, '/');
    Serial.printf("[%6lu][%c][%s:%d] %s(): %s\r\n", millis(), letter, name ? name + 1 : file, line, function, text);
}

/* ------------------------------------------------------------------ numbers and texts */

long map(long x, long in_min, long in_max, long out_min, long out_max)
{
    long span = in_max - in_min;
    long product = (long)((unsigned long)(x - in_min) * (unsigned long)(out_max - out_min));
    return span ? product / span + out_min : -1;
}

/* The board's are true chance: here they are the same in each run. */
static uint32_t chance = 0x2545F491;

uint32_t esp_random()
{
    charge(8);
    chance ^= chance << 13;
    chance ^= chance >> 17;
    return chance ^= chance << 5;
}

uint32_t READ_PERI_REG(uint32_t place)
{
    if (place != 0x3ff75144 && place != 0x60035110 && place != 0x600260b0) /* of the ESP32, S3 and C3 */
        machine::end("READ_PERI_REG: there is no register at 0x%x", place);
    return esp_random();
}

long random(long most) { return most > 0 ? (long)(esp_random() % (uint32_t)most) : 0; }
long random(long least, long most) { return least >= most ? least : least + random(most - least); }
void randomSeed(unsigned long seed) { if (seed) chance = (uint32_t)seed; }

char *ulltoa(unsigned long long value, char *to, int base)
{
    char digits[68], *at = digits + sizeof digits;
    base = base < 2 ? 10 : base;
    *--at = 0;
    do
        *--at = "0123456789abcdefghijklmnopqrstuvwxyz"[value % (unsigned)base];
    while (value /= (unsigned)base);
    return strcpy(to, at);
}

static char *with_sign(long long value, unsigned long long others, char *to, int base)
{
    if (base != 10 || value >= 0)
        return ulltoa(others, to, base);
    *to = '-';
    ulltoa(0 - (unsigned long long)value, to + 1, base);
    return to;
}

char *lltoa(long long value, char *to, int base) { return with_sign(value, (unsigned long long)value, to, base); }
char *ltoa(long value, char *to, int base) { return with_sign(value, (unsigned long)value, to, base); }
char *itoa(int value, char *to, int base) { return ltoa(value, to, base); }
char *ultoa(unsigned long value, char *to, int base) { return ulltoa(value, to, base); }
char *utoa(unsigned value, char *to, int base) { return ulltoa(value, to, base); }

char *dtostrf(double value, signed char width, unsigned char precision, char *to)
{
    charge(200);
    sprintf(to, "%*.*f", width, precision, value);
    return to;
}

bool IPAddress::fromString(const char *text)
{
    unsigned a, b, c, d;
    if (sscanf(text, "%u.%u.%u.%u", &a, &b, &c, &d) != 4 || (a | b | c | d) > 255)
        return false;
    *this = IPAddress((uint8_t)a, (uint8_t)b, (uint8_t)c, (uint8_t)d);
    return true;
}

String IPAddress::toString() const
{
    char text[16];
    snprintf(text, sizeof text, "%u.%u.%u.%u", (*this)[0], (*this)[1], (*this)[2], (*this)[3]);
    return text;
}

/* ------------------------------------------------------------------ registers of pins */

GpioRegisters GPIO;

template <typename Does> static void each_pin(int first, uint32_t pins, Does does)
{
    charge(1);
    for (int each = 0; each < 32 && first + each < board::PINS; each++)
        if (pins >> each & 1)
            does((uint8_t)(first + each));
}

uint32_t sketch_gpio_read(int first)
{
    uint32_t found = 0;
    each_pin(first, ~0u, [&](uint8_t pin) { found |= (uint32_t)machine::level(pin) << (pin - first); });
    return found;
}

void sketch_gpio_write(int first, uint32_t pins, bool level) { each_pin(first, pins, [=](uint8_t pin) { machine::drive(pin, level); }); }
void sketch_gpio_enable(int first, uint32_t pins, bool output) { each_pin(first, pins, [=](uint8_t pin) { machine::direct(pin, output); }); }
