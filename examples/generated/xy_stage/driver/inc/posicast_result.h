/* What the functions of the driver answer. */
#ifndef POSICAST_RESULT_H
#define POSICAST_RESULT_H

typedef enum {
    POSICAST_OK = 0,
    POSICAST_NOT_FOUND,    /* no stage at this address */
    POSICAST_VERSION,      /* a stage whose registers this driver does not know */
    POSICAST_BAD_ARGUMENT, /* no such axis, bank or tap; limits that are none; nothing was done */
    POSICAST_WRONG_STATE,  /* not now: see the function */
    POSICAST_FULL,         /* no room for the entry, or for the plan */
    POSICAST_TOO_LONG,     /* a stretch of the move has more ticks than an entry holds */
    POSICAST_REFUSED,      /* the hardware refused: the flags of stage and axis say what */
    POSICAST_FAULT,        /* an axis has a cause: posicast_causes */
    POSICAST_TIMEOUT,      /* it did not happen within the ticks that were allowed */
    POSICAST_DEAD,         /* time does not pass: no clock, or held in reset */
    POSICAST_NO_REFERENCE  /* neither switch nor index on the way that was allowed */
} posicast_result;

#endif
