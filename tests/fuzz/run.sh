#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# run.sh BUILD_FOLDER [MINUTES [TARGET...]]: every fuzz target for that long, one process at a time at low priority.
# New inputs collect in BUILD_FOLDER/fuzz-corpus; findings stop the target and stay in BUILD_FOLDER/fuzz-findings.
set -eu
build=${1:?which build folder}
minutes=${2:-10}
[ $# -gt 2 ] && shift 2 || set -- obj stl ply glb three_mf three_mf_model mtl png16
here=$(dirname "$0")
programs=$(dirname "$(find "$build" -name fuzz_obj -type f | head -n 1)")
status=0
for target in "$@"; do
  mkdir -p "$build/fuzz-corpus/$target" "$build/fuzz-findings"
  dictionary=
  [ -f "$here/dictionaries/$target.dict" ] && dictionary="-dict=$here/dictionaries/$target.dict"
  nice -n 15 "$programs/fuzz_$target" -max_total_time=$((60 * minutes)) -max_len=65536 -timeout=20 -rss_limit_mb=2048 \
    -malloc_limit_mb=1024 -print_final_stats=1 $dictionary -artifact_prefix="$build/fuzz-findings/$target-" \
    "$build/fuzz-corpus/$target" "$here/corpus/$target" > "$build/fuzz-$target.log" 2>&1 || status=1
  grep -E "stat::number_of_executed_units|stat::peak_rss_mb|SUMMARY|artifact" "$build/fuzz-$target.log" | sed "s/^/$target: /"
done
exit $status
