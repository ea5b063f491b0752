# SPDX-License-Identifier: MIT
# Completion of rbsim for bash; made by `rbsim --print-tables bash`.
# _rbsim_names Parameters|Cameras: those of the scene on the line
_rbsim_names()
{
	local w
	for w in "${COMP_WORDS[@]:1}"; do
		[[ $w == *.lua && -f $w ]] && "${COMP_WORDS[0]}" "$w" --help 2>/dev/null </dev/null |
			sed -n "/^$1[a-z ]* of /,/^\$/s/^  \([A-Za-z_][A-Za-z0-9_]*\).*/\1/p"
	done
}
_rbsim()
{
	local word=${COMP_WORDS[COMP_CWORD]} before=${COMP_WORDS[COMP_CWORD-1]} verb=run w
	[ "$before" = = ] && before=${COMP_WORDS[COMP_CWORD-2]}
	[ "$word" = = ] && word=
	for w in "${COMP_WORDS[@]:1:COMP_CWORD-1}"; do
		case $w in run|check|info|render|diff|replay|repair|converge|verify|methods|ctl|console|attach|sweep|collect|plot|export) verb=$w ;; esac
	done
	case $before in
	-o|--output) compopt -o filenames; COMPREPLY=($(compgen -f -- "$word")); return ;;
	--to) COMPREPLY=($(compgen -W 'csv glb vtk dump' -- "$word")); return ;;
	--against) return ;;
	-p|--param) compopt -o nospace; COMPREPLY=($(compgen -W "$(_rbsim_names Parameters)" -S = -- "$word")); return ;;
	--seeds) return ;;
	--sample) return ;;
	--task) return ;;
	--tasks) return ;;
	--time) return ;;
	--mem) return ;;
	--partition) return ;;
	--slurm-option) return ;;
	--seed) return ;;
	--duration) return ;;
	--steps) return ;;
	--time-step) return ;;
	--tolerance) return ;;
	--methods) return ;;
	--dt) return ;;
	--quantity) COMPREPLY=($(compgen -W 'position velocity orientation angular_velocity energy penetration' -- "$word")); return ;;
	--error) return ;;
	--runs) return ;;
	--budget) return ;;
	--method) COMPREPLY=($(compgen -W 'auto classic located stepped' -- "$word")); return ;;
	--rollback) COMPREPLY=($(compgen -W 'selective global none' -- "$word")); return ;;
	--threads) return ;;
	--camera) COMPREPLY=($(compgen -W "$(_rbsim_names Cameras)" -- "$word")); return ;;
	--with) return ;;
	--from) return ;;
	--fps) return ;;
	--speed) return ;;
	--size) return ;;
	--frame) return ;;
	--point-time) return ;;
	--point-disk) return ;;
	--film-timeout) return ;;
	--checkpoint-every) return ;;
	--listen) return ;;
	--commands) compopt -o filenames; COMPREPLY=($(compgen -f -- "$word")); return ;;
	--scenes) return ;;
	--jobs) return ;;
	esac
	if [[ $word == -* ]]; then
		case $verb in
		run) COMPREPLY=($(compgen -W '--output --param --duration --steps --time-step --tolerance --method --rollback --seed --threads --no-record --no-render --camera --film-timeout --checkpoint-every --resume --listen --commands --force --trust --quiet --json --debug --help --version' -- "$word")) ;;
		check) COMPREPLY=($(compgen -W '--output --param --duration --steps --time-step --tolerance --method --rollback --seed --threads --no-record --no-render --force --trust --quiet --json --debug --help --version' -- "$word")) ;;
		info) COMPREPLY=($(compgen -W '--scene --quiet --json --debug --help --version' -- "$word")) ;;
		render) COMPREPLY=($(compgen -W '--output --camera --with --from --to --fps --speed --size --frame --contact-sheet --film-timeout --force --trust --quiet --json --debug --help --version' -- "$word")) ;;
		diff) COMPREPLY=($(compgen -W '--quiet --json --debug --help --version' -- "$word")) ;;
		replay) COMPREPLY=($(compgen -W '--threads --trust --quiet --json --debug --help --version' -- "$word")) ;;
		repair) COMPREPLY=($(compgen -W '--trust --quiet --json --debug --help --version' -- "$word")) ;;
		converge) COMPREPLY=($(compgen -W '--output --param --duration --steps --methods --dt --tolerance --quantity --error --runs --budget --seed --threads --force --trust --quiet --json --debug --help --version' -- "$word")) ;;
		verify) COMPREPLY=($(compgen -W '--method --rollback --quick --scenes --jobs --quiet --json --debug --help --version' -- "$word")) ;;
		methods) COMPREPLY=($(compgen -W '--quiet --json --debug --help --version' -- "$word")) ;;
		ctl) COMPREPLY=($(compgen -W '--quiet --json --debug --help --version' -- "$word")) ;;
		console) COMPREPLY=($(compgen -W '--output --param --duration --steps --time-step --tolerance --method --rollback --seed --threads --no-record --no-render --camera --fps --speed --detach --force --trust --debug --help --version' -- "$word")) ;;
		attach) COMPREPLY=($(compgen -W '--fps --speed --trust --debug --help --version' -- "$word")) ;;
		sweep) COMPREPLY=($(compgen -W '--output --param --seeds --sample --task --tasks --status --plan --retry-failed --slurm --time --mem --partition --slurm-option --seed --duration --steps --time-step --tolerance --method --rollback --threads --no-record --no-render --camera --point-time --point-disk --film-timeout --checkpoint-every --trust --jobs --quiet --json --debug --help --version' -- "$word")) ;;
		collect) COMPREPLY=($(compgen -W '--output --csv --force --quiet --json --debug --help --version' -- "$word")) ;;
		plot) COMPREPLY=($(compgen -W '--output --against --force --quiet --json --debug --help --version' -- "$word")) ;;
		export) COMPREPLY=($(compgen -W '--output --to --force --trust --quiet --json --debug --help --version' -- "$word")) ;;
		esac
		return
	fi
	compopt -o filenames
	COMPREPLY=($(compgen -f -- "$word"))
	[ "$COMP_CWORD" -eq 1 ] && COMPREPLY+=($(compgen -W 'run check info render diff replay repair converge verify methods ctl console attach sweep collect plot export' -- "$word"))
}
complete -F _rbsim rbsim
