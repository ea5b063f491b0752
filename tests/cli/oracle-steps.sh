#!/bin/sh
# SPDX-License-Identifier: MIT
# What steps record of forces and impulses is what changes momentum, computed anew by tests/oracle.
. tests/cli/functions
find_oracle

"$python" "$oracle/scenes.py" --program "$RBSIM" --frames 2 --share steps arch dominoes heap marble_run >out ||
	fail "forces and impulses of steps are not what changes momentum"
# bodies that turning raises, spheres that pass impacts on, steps that were halved, a body wedged between floor and wall;
# what stands in halves of a step on fewer points of a face than in a whole one, bodies of which one takes parts of it,
# motion that pays for lifting, what scripts change
for first in 205 212 229 271 252,1.15 389 269 232; do
	"$python" "$oracle/scenes.py" --program "$RBSIM" --frames 2 --share random --first ${first%,*} --count 1 --one-step \
		--given "--method stepped --duration $(case $first in *,*) echo ${first#*,} ;; *) echo 1 ;; esac)" >>out ||
		fail "forces and impulses of random scene $first do not add up"
done
# steps that are halved for all: forces are means over the whole step
"$python" "$oracle/scenes.py" --program "$RBSIM" --frames 2 --share random --first 229 --count 1 --one-step \
	--given "--method stepped --rollback global --duration 1" >global
says global random-229
if grep -q 'FAIL.*steps, momentum' global; then fail "forces of steps that are halved for all do not add up"; fi
