#!/bin/sh
# A share of a deck's sets as a task of a Slurm job array:
#    sbatch --array=1-8 docs/slurm.sh many.deck
# Task K computes share K of as many as the array has tasks, and leaves part-K.lst and part-K.csv when it is done. Tasks that
# have died leave none; SHARES=8 keeps the shares where only they are run again:
#    SHARES=8 sbatch --array=3,5 docs/slurm.sh many.deck
#SBATCH --cpus-per-task=1
#SBATCH --output=part-%a.out
deck=$1
k=$SLURM_ARRAY_TASK_ID
shares=${SHARES:-$SLURM_ARRAY_TASK_COUNT}
${KINMAT:-kinmat} "$deck" --jobs 1 --sets "$k/$shares" -o "part-$k.new" --csv "part-$k.csv.new"
status=$?
# Status 2: all is computed, an instant is flagged.
[ $status -eq 0 ] || [ $status -eq 2 ] || exit $status
mv "part-$k.csv.new" "part-$k.csv" && mv "part-$k.new" "part-$k.lst"
