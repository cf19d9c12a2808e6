#!/bin/sh
# Many sets by GNU parallel and by Slurm on this machine, where they are installed: the examples of docs/many_sets.md as they
# stand there, a share that dies, and the whole compared with what one process writes.
. tests/counting.sh

here=$PWD
# Sets of several decks, eleven in all, of unequal length.
for deck in four_bar yoke jansen four_bar crank_slider; do
   cat "input/$deck.deck"
done > "$w/many.deck"
cd "$w" || exit 3
mkdir -p bin && ln -sf "$kinmat" bin/kinmat && ln -s "$here/docs" docs
PATH=$PWD/bin:$PATH
"$kinmat" many.deck --jobs 1 -o one.lst --csv one.csv
equal 'one process' 0 $?

# example N: the N-th block of commands of the document
example() { awk -v n="$1" '/^```sh/ { k++; on = k == n; next } /^```/ { on = 0 } on' docs/many_sets.md; }

for jobs in 2 5; do
   "$kinmat" many.deck --jobs $jobs -o jobs.lst --csv jobs.csv
   equal "$jobs processes" 0 $?
   same "$jobs processes: listing" one.lst jobs.lst
   same "$jobs processes: CSV" one.csv jobs.csv
done

if command -v parallel > /dev/null && parallel --version 2> /dev/null | grep -q '^GNU'; then
   example 1 > parallel.sh
   equal 'parallel: commands' 4 "$(wc -l < parallel.sh | tr -d ' ')"
   sh parallel.sh > out 2>&1
   same 'parallel: listing' one.lst many.lst
   same 'parallel: CSV' one.csv many.csv
   # A share that died: its line of the log says so, and it is run again.
   rm part-3.lst
   awk -F '\t' -v OFS='\t' '$1 == 3 { $7 = 137 } { print }' shares.log > new.log && mv new.log shares.log
   sed 's/parallel /parallel --resume-failed /' parallel.sh > again.sh
   mv part-4.lst kept.lst
   echo 'not computed again' > part-4.lst
   sed -n '/parallel/p' again.sh | sh > out 2>&1
   equal 'parallel: only the share that died' 'not computed again' "$(cat part-4.lst)"
   mv kept.lst part-4.lst
   cat part-?.lst > many.lst
   same 'parallel: after a failure' one.lst many.lst
else
   echo 'skipped: GNU parallel (not installed)'
fi

# Slurm: a cluster of this machine, with its files below $w.
stop_cluster() {
   for name in slurmd slurmctld munged; do
      [ -s $name.pid ] && kill "$(cat $name.pid)" 2> /dev/null
   done
}
start_cluster() {
   trap stop_cluster EXIT
   host=$(hostname -s)
   cat > slurm.conf <<END
ClusterName=one
SlurmctldHost=$host(127.0.0.1)
SlurmUser=root
SlurmdUser=root
AuthType=auth/munge
AuthInfo=socket=$PWD/munge.socket
CredType=cred/munge
ProctrackType=proctrack/pgid
TaskPlugin=task/none
JobAcctGatherType=jobacct_gather/none
SelectType=select/cons_tres
SelectTypeParameters=CR_CPU
ReturnToService=2
MpiDefault=none
SchedulerParameters=sched_min_interval=0,sched_interval=1,batch_sched_delay=0,defer_batch=0
StateSaveLocation=$PWD/state
SlurmdSpoolDir=$PWD/spool
SlurmctldPidFile=$PWD/slurmctld.pid
SlurmdPidFile=$PWD/slurmd.pid
SlurmctldLogFile=$PWD/slurmctld.log
SlurmdLogFile=$PWD/slurmd.log
SlurmctldPort=26817
SlurmdPort=26818
NodeName=$host NodeAddr=127.0.0.1 CPUs=$(nproc) State=UNKNOWN
PartitionName=all Nodes=ALL Default=YES State=UP
END
   export SLURM_CONF=$PWD/slurm.conf
   mkdir state spool
   dd if=/dev/urandom of=munge.key bs=128 count=1 2> /dev/null
   chmod 400 munge.key
   munged --force --key-file="$PWD/munge.key" --socket="$PWD/munge.socket" --pid-file="$PWD/munged.pid" \
      --log-file="$PWD/munged.log" --seed-file="$PWD/munge.seed" > munged.out 2>&1 && slurmctld && slurmd || return 1
   waited=0
   until sinfo 2> /dev/null | grep -q idle || [ $waited -ge 100 ]; do sleep 0.2; waited=$((waited + 1)); done
   sinfo | grep -q idle
}
if [ "$(id -u)" -eq 0 ] && command -v slurmctld > /dev/null && command -v slurmd > /dev/null && command -v munged > /dev/null; then
   rm -f part-*
   if start_cluster; then
      # The first time the task of share 5 is killed.
      cat > bin/first <<END
#!/bin/sh
case "\$*" in *"--sets 5/8"*) kill -KILL \$\$ ;; esac
exec "$kinmat" "\$@"
END
      chmod +x bin/first
      example 2 > slurm.sh
      equal 'Slurm: commands' 4 "$(wc -l < slurm.sh | tr -d ' ')"
      KINMAT=$PWD/bin/first sh -c "$(sed -n 1p slurm.sh)" > out 2>&1
      equal 'Slurm: the share that died' 'part-5.lst' "$(for k in 1 2 3 4 5 6 7 8; do [ -e part-$k.lst ] || echo part-$k.lst; done)"
      sh -c "$(sed 1d slurm.sh)" > out 2>&1
      same 'Slurm: listing' one.lst many.lst
      cat part-?.csv > many.csv
      same 'Slurm: CSV' one.csv many.csv
      equal 'Slurm: jobs' 2 "$(grep -c '^Submitted' out | awk '{ print $1 + 1 }')"
   else
      echo 'skipped: Slurm (its daemons do not start here)'
   fi
else
   echo 'skipped: Slurm (not installed, or not the superuser)'
fi
conclude
