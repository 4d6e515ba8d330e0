/* The I2C devices on the TWI, and what simavr 1.6 says otherwise than the microcontroller to masters that
 * ask its registers: ATmega2560 data sheet, tables 24-2 and 24-3. */
#ifndef I2C_H
#define I2C_H

#define TWSR 0xB9
#define TWCR 0xBC
enum { TWINT_BIT = 0x80, TWSTA_BIT = 0x20, TWSTO_BIT = 0x10, TWEN_BIT = 0x04 };
enum { TWI_ADDRESS_ACK = 0x18, TWI_ADDRESS_NACK = 0x20, TWI_DATA_ACK = 0x28, TWI_DATA_NACK = 0x30 };

static avr_irq_t *twi_input;
static int twi_addressed, twi_begun; /* the last byte was an address; a byte is on its way */

static void twi(avr_irq_t *irq, uint32_t value, void *unused)
{
    (void)irq, (void)unused;
    avr_twi_msg_irq_t message;
    message.u.v = value;
    uint8_t address = message.u.twi.addr;
    twi_begun = 1;
    if (message.u.twi.msg & TWI_COND_STOP)
        part_open = 0;
    if (message.u.twi.msg & TWI_COND_START) {
        twi_addressed = 1;
        if (part_begin(address >> 1, address & 1))
            avr_raise_irq(twi_input, avr_twi_irq_msg(TWI_COND_ACK, address, 1));
    }
    if (!part_open)
        return;
    if (message.u.twi.msg & TWI_COND_WRITE) {
        avr_raise_irq(twi_input, avr_twi_irq_msg(TWI_COND_ACK, address, (uint8_t)part_write(message.u.twi.data)));
    }
    if (message.u.twi.msg & TWI_COND_READ)
        avr_raise_irq(twi_input, avr_twi_irq_msg(TWI_COND_READ, address, part_read()));
}

/* Of an address whose byte was put into the data register it says what is right of data. */
static void twi_status(avr_irq_t *irq, uint32_t value, void *unused)
{
    (void)irq, (void)unused;
    if (twi_addressed && (value == TWI_DATA_ACK || value == TWI_DATA_NACK))
        avr->data[TWSR] = (uint8_t)((avr->data[TWSR] & 7) | (value == TWI_DATA_ACK ? TWI_ADDRESS_ACK : TWI_ADDRESS_NACK));
    twi_addressed = 0;
}

/* It leaves TWINT set while what was asked for goes on: comes after its own handler. */
static void twi_controlled(avr_t *of, avr_io_addr_t address, uint8_t value, void *unused)
{
    static uint8_t before;
    (void)unused;
    int start = value & TWSTA_BIT && !(before & TWSTA_BIT);
    if (value & TWEN_BIT && value & TWINT_BIT && (start || value & TWSTO_BIT || twi_begun))
        of->data[address] &= (uint8_t)~TWINT_BIT;
    before = of->data[address];
    twi_begun = 0;
}

static void connect_i2c(void)
{
    avr_irq_t *all = avr_io_getirq(avr, AVR_IOCTL_TWI_GETIRQ(0), 0);
    twi_input = all + TWI_IRQ_INPUT;
    avr_irq_register_notify(all + TWI_IRQ_OUTPUT, twi, 0);
    avr_irq_register_notify(all + TWI_IRQ_STATUS, twi_status, 0);
    avr_register_io_write(avr, TWCR, twi_controlled, 0);
}

#endif
