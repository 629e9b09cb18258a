/* Results of the driver's functions. */
#ifndef POSICAST_RESULT_H
#define POSICAST_RESULT_H

typedef enum {
    POSICAST_OK = 0,
    POSICAST_NOT_FOUND,    /* there is no stage at this address */
    POSICAST_VERSION,      /* the stage has registers that this driver does not know */
    POSICAST_BAD_ARGUMENT, /* invalid axis, bank, tap or limits; nothing was done */
    POSICAST_WRONG_STATE,  /* the state does not permit this; see the function */
    POSICAST_FULL,         /* there is no room for the entry, or for the plan */
    POSICAST_TOO_LONG,     /* a part of the move has more ticks than an entry can hold */
    POSICAST_REFUSED,      /* the hardware refused; the flags of stage and axis tell why */
    POSICAST_FAULT,        /* an axis has a cause; see posicast_causes */
    POSICAST_TIMEOUT,      /* it did not happen within the permitted ticks */
    POSICAST_DEAD,         /* the time stands still: no clock, or the stage is held in reset */
    POSICAST_NO_REFERENCE, /* neither switch nor index was found within the permitted distance */
    POSICAST_OTHER_MACHINE /* the stage was built from another machine file than this driver; see `refused` of the stage */
} posicast_result;

#endif
