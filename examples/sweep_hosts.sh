#!/usr/bin/env bash
# A sweep shared among hosts by GNU parallel over ssh; flexlink is on the path of each.
#
#     examples/sweep_hosts.sh host1,host2 8 link.toml move.csv 'segments.*.EI*=0.5:8:1000:log'
#
# Every host gets the files into a folder of its own, does one shard at a time on all its cores, and
# sends the shard's rows back; the folder is removed. `:` alone is this machine, without ssh.
set -euo pipefail

hosts=$1 shards=$2 link=$3 motion=$4 vary=$5
folder=(--workdir ...)
[ "$hosts" != : ] || folder=()
parallel -q --jobs 1 --sshlogin "$hosts" "${folder[@]}" \
    --transferfile "$link" --transferfile "$motion" --return "sweep-{}-of-$shards.csv" --cleanup \
    flexlink sweep "$link" "$motion" --vary "$vary" --shard "{}/$shards" --quiet \
    ::: $(seq "$shards")
shards_of_all=()
for number in $(seq "$shards"); do
    shards_of_all+=("sweep-$number-of-$shards.csv")
done
flexlink sweep --merge "${shards_of_all[@]}" -o sweep.csv
