/*
 * Gains and limits of the controllers, while the machine runs: into a bank that is not in use, then law and bank together
 * between two ticks. machine_NAME.h has the machine's; copy them, change rows, load.
 */
#ifndef POSICAST_SETTINGS_H
#define POSICAST_SETTINGS_H

#include "posicast_driver.h"

/*
 * Multiplies a gain, the word of any row but POSICAST_SETTING_LIMIT, by numerator / denominator; to the nearest word.
 * POSICAST_BAD_ARGUMENT, and nothing changed, where the denominator is 0 or the gain gets too large for a word.
 */
posicast_result posicast_scale_gain(uint32_t *word, uint16_t numerator, uint16_t denominator);

/*
 * Loads settings into bank 1 or 2 of an axis, where it is not in use, and uses them with their law. POSICAST_WRONG_STATE while the
 * bank is in use; POSICAST_TIMEOUT; POSICAST_REFUSED.
 */
posicast_result posicast_load_settings(const posicast_stage *stage, uint32_t axis, uint32_t bank,
                                       const posicast_settings *settings, uint32_t ticks);

/*
 * Back to the machine's own settings, bank 0, or to some that were loaded, with this law (POSICAST_AXIS_LAW_LAW_...), from a tick
 * on. The integral is kept. POSICAST_TIMEOUT where no tick comes.
 */
posicast_result posicast_use_settings(const posicast_stage *stage, uint32_t axis, uint32_t bank, uint32_t law,
                                      uint32_t ticks);

/*
 * Reads back what stands in bank 0 (the machine's), 1 or 2 of an axis, in use or not: a row that was not written since reset is 0.
 * `settings->law` is the law that was written last, whatever the bank. The machine runs on. POSICAST_TIMEOUT where `ticks` are over.
 */
posicast_result posicast_read_settings(const posicast_stage *stage, uint32_t axis, uint32_t bank,
                                       posicast_settings *settings, uint32_t ticks);

#endif
