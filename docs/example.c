/* KINMAT in a program in C: the largest and the smallest angle of the rocker of a four-bar. */
#include <kinmat.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

int main(void) {
   static char deck[20000];
   double *t, *row, least = HUGE_VAL, largest = -HUGE_VAL, rad = atan(1.0)/45.0;
   int status, count, rocker = 0, i;
   kinmat *k;
   FILE *file = fopen("input/four_bar.deck", "r");

   if (!file) return 3;
   deck[fread(deck, 1, sizeof deck - 1, file)] = 0;
   fclose(file);
   k = kinmat_read(deck, 1, &status);
   if (status != KINMAT_SOLVED) {
      fprintf(stderr, "%s\n", kinmat_message(k));
      kinmat_free(k);
      return status;
   }
   while (strcmp(kinmat_column(k, rocker), "ROCKER.phi") != 0) rocker++;
   count = kinmat_instants(k, NULL, 0);
   t = malloc(count*sizeof *t);
   row = malloc(kinmat_columns(k)*sizeof *row);
   kinmat_instants(k, t, count);
   for (i = 0; i < count; i++) {
      kinmat_advance(k, t[i], row);
      least = fmin(least, row[rocker]);
      largest = fmax(largest, row[rocker]);
   }
   printf("The rocker swings from %9.6f to %9.6f rad.\n", least*rad, largest*rad);
   free(t);
   free(row);
   kinmat_free(k);
   return 0;
}
