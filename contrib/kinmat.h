/* KINMAT: kinematics of planar linkages. The library prints nothing.

   A handle is one set of a deck with its place in the motion. Threads may use different handles at the same time. Only
   one thread at a time may use a handle. All numbers are in the units of the deck (card UNITS).

   KINMAT_SYSTEM rests on an estimate. If a deck needs more memory than the estimate and the process has, the run-time
   library of Fortran ends the process. */
#ifndef KINMAT_H
#define KINMAT_H
#ifdef __cplusplus
extern "C" {
#endif

typedef struct kinmat kinmat;

enum {
   KINMAT_SOLVED = 0,   /* every number exists */
   KINMAT_REJECTED = 1, /* the deck or the call has a fault; nothing is computed */
   KINMAT_FLAGGED = 2,  /* the instant is flagged; a number that does not exist is NaN */
   KINMAT_SYSTEM = 3    /* not enough memory for the deck, by an estimate from its length; nothing is computed */
};

/* Gives "KINMAT" and the version. */
const char *kinmat_version(void);

/* Reads set number `set` (from 1) of the deck `text`. The set has no VARY cards. `status` is KINMAT_SOLVED,
   KINMAT_REJECTED or KINMAT_SYSTEM. Free the handle in each case. Returns NULL if there is no memory for a handle. */
kinmat *kinmat_read(const char *text, int set, int *status);

/* Gives the reason why the set is rejected: the message of the command, with card and column. Otherwise "". */
const char *kinmat_message(const kinmat *k);

/* Counts the columns of `kinmat --table`: time, drives, quantities of PRINT or COLUMN cards. Gives 0 if the set is
   rejected. */
int kinmat_columns(const kinmat *k);

/* Names column `i`, from 0. Gives NULL if there is no such column. */
const char *kinmat_column(const kinmat *k, int i);

/* Counts the instants of the deck, and writes the times of the first `n` of them to `t`. */
int kinmat_instants(const kinmat *k, double *t, int n);

/* Solves for the time `t`, by continuity from the time of the previous call. Writes the `kinmat_columns` numbers of the
   table to `row`. A number that does not exist, or has no known digit, is NaN.
   KINMAT_REJECTED: `t` is not finite, or less than the previous time. `row` is NaN, and the place in the motion stays.
   The instants of the deck may go back (cards AT), if you call all of them in their order. */
int kinmat_advance(kinmat *k, double t, double *row);

/* Frees a handle. Does nothing for NULL. */
void kinmat_free(kinmat *k);

#ifdef __cplusplus
}
#endif
#endif
