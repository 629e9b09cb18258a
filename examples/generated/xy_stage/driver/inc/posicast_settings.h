/*
 * Changes of the controllers' gains and limits while the machine runs: they are loaded into a bank that is not active, then law
 * and bank change together between two ticks. machine_NAME.h has the machine's settings; copy them, change rows, load them.
 */
#ifndef POSICAST_SETTINGS_H
#define POSICAST_SETTINGS_H

#include "posicast_driver.h"

/*
 * Multiplies a gain, which is the word of any row except POSICAST_SETTING_LIMIT, by numerator / denominator, rounded to the
 * nearest word. Returns POSICAST_BAD_ARGUMENT and changes nothing if the denominator is 0 or the gain becomes too large.
 */
posicast_result posicast_scale_gain(uint32_t *word, uint16_t numerator, uint16_t denominator);

/*
 * Loads settings into bank 1 or 2 of an axis, which must not be active, and activates them with their law. Returns
 * POSICAST_WRONG_STATE while the bank is active, POSICAST_TIMEOUT or POSICAST_REFUSED.
 */
posicast_result posicast_load_settings(const posicast_stage *stage, uint32_t axis, uint32_t bank,
                                       const posicast_settings *settings, uint32_t ticks);

/*
 * Activates the machine's own settings in bank 0, or some that were loaded before, with this law (POSICAST_AXIS_LAW_LAW_...),
 * from a tick on. The integral is kept. Returns POSICAST_TIMEOUT if no tick comes.
 */
posicast_result posicast_use_settings(const posicast_stage *stage, uint32_t axis, uint32_t bank, uint32_t law,
                                      uint32_t ticks);

/*
 * Reads back the settings in bank 0 (the machine's own), 1 or 2 of an axis, active or not: a row that was not written since reset
 * is 0. `settings->law` is the law that was written last, whatever the bank. The machine keeps running. Returns POSICAST_TIMEOUT
 * after `ticks`.
 */
posicast_result posicast_read_settings(const posicast_stage *stage, uint32_t axis, uint32_t bank,
                                       posicast_settings *settings, uint32_t ticks);

#endif
