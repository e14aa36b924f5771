# Completion of moma for fish. Now and here: moma completion fish | source. Installed, it is
# share/fish/vendor_completions.d/moma.fish, which fish reads by itself.
function __moma_words
    set -l before (commandline -opc)
    set -l current (commandline -ct)
    for line in ($before[1] completion words -- $before[2..-1] "$current" 2>/dev/null)
        set -l parts (string split -m 1 \t -- $line)
        if test "$parts[1]" != :files
            echo $line
            continue
        end
        set -l head (string match -r -- '^--[^=]*=' $current)
        for file in (__fish_complete_path (string replace -r -- '^--[^=]*=' '' $current))
            set -l path (string split -m 1 \t -- $file)[1]
            set -l ending (string match -r '[^.]*$' -- $path)
            if test -z "$parts[2]"; or string match -q '*/' -- $path; or contains -- $ending (string split ' ' -- $parts[2])
                echo "$head$path"
            end
        end
    end
end
complete -c moma -f -a '(__moma_words)'
