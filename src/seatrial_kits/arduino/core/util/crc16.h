/* Cyclic redundancy checks, a byte at a time. */
#ifndef CRC16_H
#define CRC16_H
#include <stdint.h>

inline uint16_t crc_up(uint16_t crc, uint16_t polynomial)
{
    for (int i = 0; i < 8; i++)
        crc = (uint16_t)(crc & 0x8000 ? crc << 1 ^ polynomial : crc << 1);
    return crc;
}

inline uint16_t crc_down(uint16_t crc, uint16_t polynomial)
{
    for (int i = 0; i < 8; i++)
        crc = (uint16_t)(crc & 1 ? crc >> 1 ^ polynomial : crc >> 1);
    return crc;
}

inline uint16_t _crc16_update(uint16_t crc, uint8_t data) { return crc_down(crc ^ data, 0xA001); }
inline uint16_t _crc_ccitt_update(uint16_t crc, uint8_t data) { return crc_down(crc ^ data, 0x8408); }
inline uint16_t _crc_xmodem_update(uint16_t crc, uint8_t data) { return crc_up((uint16_t)(crc ^ data << 8), 0x1021); }
inline uint8_t _crc_ibutton_update(uint8_t crc, uint8_t data) { return (uint8_t)crc_down(crc ^ data, 0x8C); }
inline uint8_t _crc8_ccitt_update(uint8_t crc, uint8_t data) { return (uint8_t)(crc_up((uint16_t)((crc ^ data) << 8), 0x0700) >> 8); }
#endif
