#define _GNU_SOURCE
/* What tests/system/library.sh asks of the shared library. See each command below for what it prints. */
#include <math.h>
#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <unistd.h>
#include "kinmat.h"

static char *text_of(const char *path) {
   FILE *file = fopen(path, "rb");
   long length;
   char *text;
   if (!file) { perror(path); exit(3); }
   fseek(file, 0, SEEK_END);
   length = ftell(file);
   rewind(file);
   text = malloc(length + 1);
   text[fread(text, 1, length, file)] = 0;
   fclose(file);
   return text;
}

/* The whole run of a set: rows one after another. Returns the number of columns, 0 if it is rejected. */
static int run(const char *text, double **rows, int *count, int *worst) {
   int status, columns, i;
   double *t;
   kinmat *k = kinmat_read(text, 1, &status);
   *worst = status;
   *rows = NULL;
   *count = kinmat_instants(k, NULL, 0);
   columns = kinmat_columns(k);
   if (status == KINMAT_SOLVED) {
      t = malloc(*count*sizeof *t);
      *rows = malloc((size_t)*count*columns*sizeof **rows);
      kinmat_instants(k, t, *count);
      for (i = 0; i < *count; i++) {
         status = kinmat_advance(k, t[i], *rows + (size_t)i*columns);
         if (status > *worst) *worst = status;
      }
      free(t);
   }
   kinmat_free(k);
   return columns;
}

/* table DECK: the table of the first set, as `kinmat --table` writes it, and its status; or the message. */
static int table(const char *path) {
   char *text = text_of(path), cell[40];
   double *rows;
   int count, worst, columns, i, j, status;
   kinmat *k = kinmat_read(text, 1, &status);
   if (status) {
      puts(kinmat_message(k));
      kinmat_free(k);
      free(text);
      return status;
   }
   columns = run(text, &rows, &count, &worst);
   for (j = 0; j < columns; j++) printf("%s%s", j ? "," : "", kinmat_column(k, j));
   puts("");
   for (i = 0; i < count; i++) {
      for (j = 0; j < columns; j++) {
         double x = rows[(size_t)i*columns + j];
         char *e;
         if (x != x) {
            printf("%sNaN", j ? "," : "");
            continue;
         }
         /* 17 digits, and three in the exponent. */
         snprintf(cell, sizeof cell, "%.16E", x);
         e = strchr(cell, 'E');
         printf("%s%.*s%c%03d", j ? "," : "", (int)(e - cell) + 1, cell, e[1], abs(atoi(e + 1)));
      }
      puts("");
   }
   kinmat_free(k);
   free(rows);
   free(text);
   return worst;
}

/* threads N DECK...: N threads run all decks, each from another one on; every row is that of a run alone, bit for bit. */
typedef struct { int first, decks, passes; char **text; double **rows; int *columns, *count; int differ; } job;

static void *work(void *argument) {
   job *j = argument;
   int i;
   for (i = 0; i < j->passes*j->decks; i++) {
      int n = (j->first + i)%j->decks, count, worst;
      double *rows;
      int columns = run(j->text[n], &rows, &count, &worst);
      if (columns != j->columns[n] || count != j->count[n] || (columns > 0 &&
          memcmp(rows, j->rows[n], (size_t)count*columns*sizeof *rows) != 0)) j->differ++;
      free(rows);
   }
   return NULL;
}

static int threads(int n, int decks, char **path) {
   pthread_t *thread = malloc(n*sizeof *thread);
   job *jobs = malloc(n*sizeof *jobs), one = {0, decks, 1, NULL, NULL, NULL, NULL, 0};
   int i, worst, differ = 0;
   one.text = malloc(decks*sizeof *one.text);
   one.rows = malloc(decks*sizeof *one.rows);
   one.columns = malloc(decks*sizeof *one.columns);
   one.count = malloc(decks*sizeof *one.count);
   for (i = 0; i < decks; i++) {
      one.text[i] = text_of(path[i]);
      one.columns[i] = run(one.text[i], &one.rows[i], &one.count[i], &worst);
   }
   for (i = 0; i < n; i++) {
      jobs[i] = one;
      jobs[i].first = i*decks/n;
      pthread_create(&thread[i], NULL, work, &jobs[i]);
   }
   for (i = 0; i < n; i++) {
      pthread_join(thread[i], NULL);
      differ += jobs[i].differ;
   }
   printf("%d runs, %d differ\n", n*decks, differ);
   for (i = 0; i < decks; i++) {
      free(one.text[i]);
      free(one.rows[i]);
   }
   free(one.text); free(one.rows); free(one.columns); free(one.count);
   free(thread); free(jobs);
   return differ > 0;
}

/* reads N DECK...: reads them in turn, solves the first instant of those that are not rejected, frees them. */
static int reads(int n, int decks, char **path) {
   int i, status, rejected = 0;
   char **text = malloc(decks*sizeof *text);
   for (i = 0; i < decks; i++) text[i] = text_of(path[i]);
   for (i = 0; i < n; i++) {
      kinmat *k = kinmat_read(text[i%decks], 1, &status);
      if (status == KINMAT_SOLVED) {
         double *row = malloc(kinmat_columns(k)*sizeof *row), t;
         kinmat_instants(k, &t, 1);
         kinmat_advance(k, t, row);
         free(row);
      } else rejected++;
      kinmat_free(k);
   }
   printf("%d reads, %d rejected\n", n, rejected);
   for (i = 0; i < decks; i++) free(text[i]);
   free(text);
   return 0;
}

/* calls DECK REJECTED: the calls that have a fault, and what each returns. */
static int calls(const char *path, const char *rejected) {
   char *text = text_of(path), *bad = text_of(rejected);
   int status, i, columns;
   double t[3], *row, *before;
   kinmat *k = kinmat_read(text, 1, &status);
   columns = kinmat_columns(k);
   row = malloc(columns*sizeof *row);
   before = malloc(columns*sizeof *row);
   t[2] = -1.0;
   printf("version %s\n", kinmat_version());
   printf("read %d '%s'\n", status, kinmat_message(k));
   i = kinmat_instants(k, t, 2) > 3 && t[1] > t[0] && t[2] == -1.0;
   printf("instants %d\n", i);
   printf("columns %d %s %s\n", columns, kinmat_column(k, -1) ? "?" : "none", kinmat_column(k, columns) ? "?" : "none");
   printf("later %d\n", kinmat_advance(k, t[1], before));
   printf("earlier %d", kinmat_advance(k, t[0], row));
   for (i = 0; i < columns && row[i] != row[i]; i++) ;
   printf(" %s\n", i == columns ? "NaN" : "?");
   printf("not a number %d\n", kinmat_advance(k, row[0], row));
   printf("infinite %d\n", kinmat_advance(k, 1e300*1e300, row));
   printf("again %d", kinmat_advance(k, t[1], row));
   for (i = 0; i < columns && fabs(row[i] - before[i]) <= 1e-12*(1.0 + fabs(before[i])); i++) ;
   printf(" %s\n", i == columns ? "as before" : "?");
   kinmat_free(k);
   for (i = -1; i < 3; i += 3) {
      k = kinmat_read(text, i, &status);
      printf("set %d: %d '%s'\n", i, status, kinmat_message(k));
      kinmat_free(k);
   }
   k = kinmat_read(bad, 1, NULL);
   printf("rejected: columns %d, column %s, instants %d, advance %d\n", kinmat_columns(k),
      kinmat_column(k, 0) ? "?" : "none", kinmat_instants(k, t, 3), kinmat_advance(k, 0.0, row));
   kinmat_free(k);
   k = kinmat_read(NULL, 1, &status);
   printf("null: %d '%s'\n", status, kinmat_message(k));
   kinmat_free(k);
   kinmat_free(NULL);
   printf("null: '%s' columns %d, advance %d\n", kinmat_message(NULL), kinmat_columns(NULL), kinmat_advance(NULL, 0.0, row));
   free(row); free(before); free(text); free(bad);
   return 0;
}

/* memory DECK: reads it with 30 MB more than the process has, then without a limit. */
static int memory(const char *path) {
   char *text = text_of(path);
   long pages = 0;
   int status;
   struct rlimit limit;
   FILE *file = fopen("/proc/self/statm", "r");
   kinmat *k;
   if (!file || fscanf(file, "%ld", &pages) != 1) return 3;
   fclose(file);
   getrlimit(RLIMIT_AS, &limit);
   limit.rlim_cur = pages*sysconf(_SC_PAGESIZE) + 30000000;
   setrlimit(RLIMIT_AS, &limit);
   k = kinmat_read(text, 1, &status);
   printf("%d '%s' %d\n", status, kinmat_message(k), kinmat_columns(k));
   kinmat_free(k);
   limit.rlim_cur = limit.rlim_max;
   setrlimit(RLIMIT_AS, &limit);
   k = kinmat_read(text, 1, &status);
   printf("%d '%s'\n", status, kinmat_message(k));
   kinmat_free(k);
   free(text);
   return 0;
}

int main(int argc, char **argv) {
   if (argc > 2 && !strcmp(argv[1], "table")) return table(argv[2]);
   if (argc > 3 && !strcmp(argv[1], "threads")) return threads(atoi(argv[2]), argc - 3, argv + 3);
   if (argc > 3 && !strcmp(argv[1], "reads")) return reads(atoi(argv[2]), argc - 3, argv + 3);
   if (argc > 2 && !strcmp(argv[1], "memory")) return memory(argv[2]);
   if (argc > 3 && !strcmp(argv[1], "calls")) return calls(argv[2], argv[3]);
   return 3;
}
