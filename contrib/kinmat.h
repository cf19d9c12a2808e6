/* KINMAT: kinematics of planar linkages. The library prints nothing.

   A handle is one set of a deck and where it is in its motion. Threads may use different handles at a time, and one
   handle one after another. Lengths and times are in the units of the deck, angles in degrees or radians, as its card
   UNITS says.

   Without memory for what the estimate did not foresee, the run-time library of Fortran ends the process. */
#ifndef KINMAT_H
#define KINMAT_H
#ifdef __cplusplus
extern "C" {
#endif

typedef struct kinmat kinmat;

enum {
   KINMAT_SOLVED = 0,   /* every number exists */
   KINMAT_REJECTED = 1, /* the deck, or the call, has a fault; nothing is computed */
   KINMAT_FLAGGED = 2,  /* the instant is flagged: a number may not exist, and is NaN */
   KINMAT_SYSTEM = 3    /* not enough memory for the deck, by an estimate from its length; nothing is computed */
};

/* Gives "KINMAT" and the version. */
const char *kinmat_version(void);

/* Reads set number `set` (from 1) of the deck `text`, a set without VARY cards. `status`: KINMAT_SOLVED,
   KINMAT_REJECTED or KINMAT_SYSTEM. Free the handle in each case. NULL: not enough memory. */
kinmat *kinmat_read(const char *text, int set, int *status);

/* Says why the set is rejected: the message of the command, with card and column. "" if it is not. */
const char *kinmat_message(const kinmat *k);

/* Counts the columns, those of `kinmat --table`: time, drives, what PRINT or COLUMN cards ask for. 0: rejected. */
int kinmat_columns(const kinmat *k);

/* Names column `i`, from 0. NULL if there is none. */
const char *kinmat_column(const kinmat *k, int i);

/* Counts the instants of the deck, and writes the times of the first `n` of them to `t`. */
int kinmat_instants(const kinmat *k, double *t, int n);

/* Solves for the time `t`, by continuity from the time of the call before. Writes the `kinmat_columns` numbers of the
   table to `row`; a number that does not exist, or has no known digit, is NaN.
   KINMAT_REJECTED: `t` is not finite, or before the time of the call before; `row` is NaN, and the motion stays.
   Only the instants of the deck may go back, if all are called in their order. */
int kinmat_advance(kinmat *k, double t, double *row);

/* Frees a handle. NULL is none. */
void kinmat_free(kinmat *k);

#ifdef __cplusplus
}
#endif
#endif
