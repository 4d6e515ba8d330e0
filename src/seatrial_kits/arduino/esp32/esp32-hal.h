/* What Arduino-ESP32 has besides Arduino: PWM by LEDC, hardware timers, logs, touch, clock. */
#ifndef ESP32_HAL_H
#define ESP32_HAL_H

#include "esp32-hal-log.h"
#include "esp_timer.h"

/* LEDC by channels, as before version 3.0, and by pins, from then on. */
double ledcSetup(uint8_t channel, double frequency, uint8_t bits);
void ledcAttachPin(uint8_t pin, uint8_t channel);
void ledcDetachPin(uint8_t pin);
bool ledcAttach(uint8_t pin, uint32_t frequency, uint8_t bits);
bool ledcAttachChannel(uint8_t pin, uint32_t frequency, uint8_t bits, uint8_t channel);
bool ledcDetach(uint8_t pin);
void ledcWrite(uint8_t channel_or_pin, uint32_t duty);
bool ledcWriteChannel(uint8_t channel, uint32_t duty);
uint32_t ledcRead(uint8_t channel_or_pin);
double ledcReadFreq(uint8_t channel_or_pin);
double ledcChangeFrequency(uint8_t channel_or_pin, double frequency, uint8_t bits);
double ledcWriteTone(uint8_t channel_or_pin, double frequency);
void analogWrite(uint8_t pin, int value);
void analogWriteFrequency(uint32_t frequency);
void analogWriteFrequency(uint8_t pin, uint32_t frequency);
void analogWriteResolution(uint8_t bits);
void analogWriteResolution(uint8_t pin, uint8_t bits);
void tone(uint8_t pin, unsigned frequency, unsigned long duration = 0);
void noTone(uint8_t pin);

/* Hardware timers: by number and divider, as before version 3.0, and by frequency, from then on. */
typedef struct hw_timer_s hw_timer_t;
hw_timer_t *timerBegin(uint8_t number, uint16_t divider, bool up);
hw_timer_t *timerBegin(uint32_t frequency);
void timerEnd(hw_timer_t *timer);
void timerAttachInterrupt(hw_timer_t *timer, void (*handler)(), bool edge = true);
void timerAttachInterruptArg(hw_timer_t *timer, void (*handler)(void *), void *argument);
void timerDetachInterrupt(hw_timer_t *timer);
void timerAlarmWrite(hw_timer_t *timer, uint64_t value, bool again);
void timerAlarmEnable(hw_timer_t *timer);
void timerAlarmDisable(hw_timer_t *timer);
bool timerAlarmEnabled(hw_timer_t *timer);
void timerAlarm(hw_timer_t *timer, uint64_t value, bool again, uint64_t count);
void timerStart(hw_timer_t *timer);
void timerStop(hw_timer_t *timer);
void timerRestart(hw_timer_t *timer);
void timerWrite(hw_timer_t *timer, uint64_t value);
uint64_t timerRead(hw_timer_t *timer);
uint64_t timerReadMicros(hw_timer_t *timer);
uint64_t timerReadMilis(hw_timer_t *timer);

uint32_t READ_PERI_REG(uint32_t place); /* of registers by their addresses, that of random numbers */
inline bool setCpuFrequencyMhz(uint32_t) { return true; }
inline uint32_t getCpuFrequencyMhz() { return 240; }
inline uint32_t getApbFrequency() { return 80000000; }
inline float temperatureRead() { return 50.0f; }
inline void disableCore0WDT() {}
inline void enableCore0WDT() {}
inline void disableCore1WDT() {}
inline void enableLoopWDT() {}
inline void disableLoopWDT() {}
inline void feedLoopWDT() {}
inline bool btStop() { return true; }
inline bool psramFound() { return false; }
inline void *ps_malloc(size_t size) { return malloc(size); }
/* The clock of the calendar stands at 1970, as on a board that has asked nobody. */
inline void configTime(long, int, const char *, const char * = nullptr, const char * = nullptr) {}
inline bool getLocalTime(struct tm *, uint32_t = 5000) { return false; }

#endif
