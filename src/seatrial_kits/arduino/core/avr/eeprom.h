/* EEPROM by avr-libc's names. */
#ifndef AVR_EEPROM_H
#define AVR_EEPROM_H
#include <stddef.h>
#include <stdint.h>
#define EEMEM __attribute__((section("sketch_eemem")))
void eeprom_read_block(void *to, const void *from, size_t count);
void eeprom_write_block(const void *from, void *to, size_t count);
void eeprom_update_block(const void *from, void *to, size_t count);
#define EEPROM_ACCESS(name, type) \
    inline type eeprom_read_##name(const type *at) { type value; eeprom_read_block(&value, at, sizeof value); return value; } \
    inline void eeprom_write_##name(type *at, type value) { eeprom_write_block(&value, at, sizeof value); } \
    inline void eeprom_update_##name(type *at, type value) { eeprom_update_block(&value, at, sizeof value); }
EEPROM_ACCESS(byte, uint8_t)
EEPROM_ACCESS(word, uint16_t)
EEPROM_ACCESS(dword, uint32_t)
EEPROM_ACCESS(float, float)
bool eeprom_ready();
#define eeprom_is_ready() eeprom_ready()
#define eeprom_busy_wait() do {} while (!eeprom_ready())
#endif
