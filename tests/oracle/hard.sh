#!/bin/sh
# make hard: errors in units of what the condition allows, a line a scene; make hard-short (hard.sh short): in fewer instants.
# The last line is `N passed, N failed`.
exec "${BUILD:-build}/release/hard" "$1" input/*.deck
