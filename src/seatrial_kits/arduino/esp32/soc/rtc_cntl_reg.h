/* The register of the brown-out detector: a board without supply is off, whatever it says. */
#ifndef SOC_RTC_CNTL_REG_H
#define SOC_RTC_CNTL_REG_H

namespace sketch_register { enum { RTC_CNTL_BROWN_OUT_REG }; }

#endif
