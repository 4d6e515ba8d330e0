/* Voltages at the ADC, and what simavr 1.6 does otherwise than the data sheet of the ATmega2560 (chapter 26):
 * it has eight channels, whole millivolts, 1023 in the place of 1024, and ADSC stays set without ADEN. */
#ifndef ADC_H
#define ADC_H

#define ADCSRA 0x7A
#define ADCSRB 0x7B
#define CHANNELS 16
#define UNITS 5 /* of a millivolt: simavr has 13 bits for its band gap */
enum { ADEN_BIT = 0x80, ADSC_BIT = 0x40, MUX5_BIT = 0x08 };

static avr_adc_t *adc;
static uint16_t adc_units[CHANNELS];

static void adc_put(uint8_t channel, double volts)
{
    double units = ceil(volts * 1000.0 * UNITS * 1024.0 / 1023.0);
    adc_units[channel % CHANNELS] = (uint16_t)fmin(fmax(units, 0.0), 65535.0);
}

/* A conversion begins. */
static void adc_sample(avr_irq_t *irq, uint32_t value, void *unused)
{
    (void)irq, (void)value, (void)unused;
    int upper = ports[0] == 'E' && avr->data[ADCSRB] & MUX5_BIT;
    memcpy(adc->adc_values, adc_units + (upper ? 8 : 0), sizeof adc->adc_values);
}

/* A global constructor may call analogRead() before the core has switched the ADC on. */
static void adc_controlled(avr_t *of, avr_io_addr_t address, uint8_t value, void *unused)
{
    (void)unused;
    if (!(value & ADEN_BIT))
        of->data[address] &= (uint8_t)~ADSC_BIT;
}

static void connect_adc(void)
{
    avr_io_t *io = avr->io_port;
    while (io && strcmp(io->kind, "adc"))
        io = io->next;
    if (!io)
        end("simavr has no ADC for this microcontroller");
    adc = (avr_adc_t *)io;
    for (unsigned each = 0; each < sizeof adc->ref_values / sizeof *adc->ref_values; each++)
        if (adc->ref_values[each] >= ADC_VREF_V110)
            adc->ref_values[each] *= UNITS;
    for (unsigned each = 0; each < sizeof adc->muxmode / sizeof *adc->muxmode; each++) {
        avr_adc_mux_t *mux = &adc->muxmode[each];
        if (mux->kind == ADC_MUX_REF)
            mux->src *= UNITS;
        else if (mux->kind == ADC_MUX_SINGLE)
            mux->src %= 8;
    }
    avr->vcc = avr->avcc = avr->aref = 5000 * UNITS;
    avr_irq_register_notify(avr_io_getirq(avr, AVR_IOCTL_ADC_GETIRQ, ADC_IRQ_OUT_TRIGGER), adc_sample, 0);
    avr_register_io_write(avr, ADCSRA, adc_controlled, 0);
}

#endif
