#!/bin/sh
# What `make install` leaves: the command, its man page, and a library with modules that another program can use.
. tests/counting.sh

"${MAKE:-make}" --no-print-directory BUILD="$BUILD" DESTDIR="$w" PREFIX=/usr install > "$w/out" 2>&1
equal 'make install: status' 0 $?
equal 'make install: directories' 'bin include lib share ' "$(ls "$w/usr" | tr '\n' ' ')"
equal 'make install: a module for each source of the library' "$( (find src -name '*.[fF]90'; echo document_texts.f90) | sed -e 's/.*\///' -e 's/\..*/.mod/' | grep -vE '^(main|allocation)[.]' \
   | LC_ALL=C sort)" "$(ls "$w/usr/include/kinmat" | LC_ALL=C sort)"
"$w/usr/bin/kinmat" input/yoke.deck > "$w/out" 2> "$w/err"
same 'the installed command' expected/yoke.lst "$w/out"

# The example of docs/ with what is installed, and nothing else.
(cd "$w" && "${FC:-gfortran}" -fno-lto -fno-use-linker-plugin -Iusr/include/kinmat -o example usr/share/doc/kinmat/docs/example.f90 -Lusr/lib -lkinmat -lklu -llapack -lblas) \
   > "$w/err" 2>&1
equal 'a program with the installed modules: it is built' '' "$(cat "$w/err")"
equal 'a program with the installed modules' "$("$BUILD/example")" "$("$w/example")"

# The library for C, by -lkinmat, which leaves Fortran the static one; kinmat.py finds it.
library=$w/usr/lib
(cd "$w" && gcc -Iusr/include -o c usr/share/doc/kinmat/docs/example.c -Lusr/lib -lkinmat -lm) > "$w/err" 2>&1
equal 'a program in C: it is built' '' "$(cat "$w/err")"
equal 'a program in C' "$("$BUILD/example")" "$(LD_LIBRARY_PATH=$library "$w/c" 2>&1)"
equal 'the shared library is that of C alone' '1 0' "$(for program in c example; do readelf -d "$w/$program" | grep -c 'NEEDED.*libkinmat[.]so[.]2'; done | tr '\n' ' ' | sed 's/ $//')"
equal 'the name of the library' 'libkinmat.so.2' "$(readelf -d "$library/libkinmat.so.2" | sed -n 's/.*SONAME.*\[\(.*\)\]/\1/p')"
equal 'what pkg-config reads' 'prefix=/usr,Version: 2.0,Cflags: -I${includedir},Libs: -L${libdir} -lkinmat,' \
   "$(grep -E '^(prefix|Version|Cflags|Libs)' "$library/pkgconfig/kinmat.pc" | tr '\n' ',')"
equal 'the installed kinmat.py' 'KINMAT 2.0' "$(cd "$w" && env -u LIBKINMAT -u LD_LIBRARY_PATH PYTHONDONTWRITEBYTECODE=1 PYTHONPATH=usr/share/kinmat python3 -c 'import kinmat; print(kinmat.version())' 2>&1)"

# Every link of an installed document leads to an installed file.
documents=$w/usr/share/doc/kinmat
(cd "$documents" && find . -name '*.md' | LC_ALL=C sort) > "$w/documents"
equal 'installed documents' "$(find CHANGELOG.md README.md docs src/README.md -name '*.md' | LC_ALL=C sort)" "$(sed 's/^[.]\///' "$w/documents")"
while read -r document; do
   grep -oE '(\]\([^)]*\)|src="[^"]*")' "$documents/$document" | sed -e 's/^](//' -e 's/)$//' -e 's/^src="//' -e 's/"$//' -e 's/#.*//' | sort -u \
      | while read -r link; do
         case $link in http*|'') continue ;; esac
         echo "$link" >> "$w/links"
         [ -s "$documents/$(dirname "$document")/$link" ] || echo "$document: $link"
      done
done < "$w/documents" > "$w/dead"
equal 'links of installed documents that lead nowhere' '' "$(cat "$w/dead")"
equal 'links of installed documents are found' yes "$([ "$(wc -l < "$w/links")" -ge 20 ] && echo yes)"
equal 'the license is installed' yes "$(cmp -s LICENSE "$documents/LICENSE" && echo yes)"
equal 'the decks are installed' "$(ls input)" "$(ls "$documents/input")"

# The man page has each option of --help, and no fault that its readers find.
page=$w/usr/share/man/man1/kinmat.1
"$w/usr/bin/kinmat" --help | sed -n 's/^  \(-[-a-z]*\).*/\1/p' > "$w/options"
equal 'the man page: options are found' yes "$([ "$(wc -l < "$w/options")" -ge 14 ] && echo yes)"
equal 'the man page: options it lacks' '' "$(while read -r option; do tr -d '\\' < "$page" | grep -qF -- "fB$option" || echo "$option"; done < "$w/options")"
equal 'the man page: its sections' 'NAME SYNOPSIS DESCRIPTION OPTIONS EXIT STATUS EXAMPLES SEE ALSO ' "$(sed -n 's/^[.]SH //p' "$page" | tr '\n' ' ')"
equal 'the man page: exit statuses' '0 1 2 3 130 143 141 ' "$(sed -n '/^.SH EXIT/,$p' "$page" | grep -E '^[0-9]+$' | tr '\n' ' ')"
readme=$(sed -n 's/.*fI\(.*README[.]md\).*/\1/p' "$page")
equal 'the man page: the documents where they are' "/usr/share/doc/kinmat/README.md there" "$readme $([ -s "$w$readme" ] && echo there)"
equal 'the man page: lines over 120 columns' '' "$(awk 'length > 120' "$page")"
read_page() { if command -v "$1" > /dev/null; then equal "the man page: $1" '' "$("$@" "$page" 2>&1 > /dev/null)"; else echo "skipped: the man page in $1 (not installed)"; fi; }
read_page groff -man -Tascii -ww -z
read_page mandoc -T lint -W error
conclude
