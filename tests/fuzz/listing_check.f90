!> Tests. A listing read as a reader would: every place of a number holds a number or the word for none, nothing else.
module listing_check
   implicit none
   private
   public :: check_listing, check_protocol, next_word

   !> Characters of a line in memory, and of one of the listing at most.
   integer, parameter :: width = 400, longest = 120
   !> A line of a sentence that goes on in the next one is shorter by less.
   integer, parameter :: longest_word = 20
   character(14), parameter :: heads(*) = [character(14) :: 'X', 'Y', 'PHI', 'FI', 'VX', 'VY', 'VPHI', 'VFI', 'AX', &
      'AY', 'APHI', 'AFI', 'SLIDE', 'ANGLE', 'PRZESUW', 'KAT', 'VELOCITY', 'ACCELERATION', 'PREDKOSC', &
      'PRZYSPIESZENIE', 'XI-I', 'KSI-I', 'LENGTH', 'DLUGOSC', 'ETA-I', 'XI-J', 'KSI-J', &
      'ETA-J', 'DIRECTION', 'KIERUNEK', 'TANGENT', 'STYCZNA', 'RADIUS', 'PROMIEN', &
      'X-CENTRE', 'X-SRODKA', 'Y-CENTRE', 'Y-SRODKA', 'VALUE', 'WARTOSC', 'DERIVATIVE', 'POCHODNA']
   !> Words in the place of a number.
   character(10), parameter :: words_for_none(*) = [character(10) :: 'NONE', 'BRAK', 'INFINITE', 'NIESKONCZ.', 'AT', &
      'REST', 'W', 'SPOCZYNKU', 'UNBOUNDED', 'NIEOGRAN.', 'COINCIDE', 'POKRYCIE']
   !> What begins tables of other forms, behind those of the motion.
   character(14), parameter :: other_heads(*) = [character(14) :: 'CONTINUATION:', 'KONTYNUACJA:', 'TOLERANCES:', &
      'TOLERANCJE:', &
      'ASSEMBLIES', 'MONTAZE', 'RANGES OF', 'ZAKRESY', 'CIRCUITS AND', 'OBWODY I', 'PROOF:', 'DOWOD:']
   !> Columns of the names of a row; of one with two names; of a ratio, a quantity BY a drive.
   integer, parameter :: one_name = 9, two_names = 18, ratio_names = 44
   character(110), parameter :: marks(*) = [character(110) :: 'NO POSITION FOUND', 'NIE ZNALEZIONO POLOZENIA', &
      'JACOBIAN SINGULAR: NO UNIQUE VELOCITIES', 'JAKOBIAN OSOBLIWY: BRAK JEDNOZNACZNYCH PREDKOSCI', &
      'CHANGE POINT: VELOCITIES NOT UNIQUE', 'PUNKT ZMIANY: PREDKOSCI NIEJEDNOZNACZNE', &
      'DEAD POINT: NO FINITE VELOCITIES', 'PUNKT MARTWY: BRAK SKONCZONYCH PREDKOSCI', &
      'OUT OF STROKE', 'POZA SKOKIEM', 'THE RESULT IS TOO LARGE A NUMBER', 'WYNIK JEST ZBYT DUZA LICZBA', &
      'REDUNDANT EQUATIONS ARE INCONSISTENT', 'ROWNANIA NADLICZBOWE SA SPRZECZNE', &
      'REDUNDANT EQUATIONS ARE INCONSISTENT: FOR ROUNDED NUMBERS GIVE METHOD, REAL-2, A CLOSING TOLERANCE', &
      'ROWNANIA NADLICZBOWE SA SPRZECZNE: DLA LICZB ZAOKRAGLONYCH PODAJ METHOD, REAL-2, TOLERANCJE ZAMKNIECIA']
   !> What a remark holds, after three stars or three dashes.
   character(60), parameter :: diagnostics(*) = [character(60) :: 'CLOSURE ERROR', 'BLAD ZAMKNIECIA', &
      ': LENGTH ', ': DLUGOSC ', ': ONLY LENGTHS BELOW 0', ': TYLKO DLUGOSCI PONIZEJ 0', &
      'IN THE STEP TO T =', 'W KROKU DO CHWILI T =', 'WHOLE TURNS ARE UNCERTAIN', 'LICZBA OBROTOW NIEPEWNA', &
      'AT THE LIMIT', 'NA KRESIE RUCHU', &
      'THIS INSTANT IS AT THE CHANGE POINT', 'CHWILA LEZY W NIM', &
      'PASSED ON THE SMOOTH BRANCH', 'RUCH PRZECHODZI GLADKO', &
      'A DRIVE IS TOO MANY, REMOVE ONE OF: ', 'JEDEN NAPED JEST ZBEDNY, USUN JEDEN Z: ', &
      'CHANGE POINT AT T =', 'PUNKT ZMIANY W CHWILI T =', 'NOT FULLY CONSTRAINED BY THE DRIVES: DRIVE ONE OF THEM', &
      'RUCH NIEOKRESLONY, NAPEDZAJ JEDNO Z NICH', &
      'THE ASSEMBLY FOUND DIFFERS FROM THE INITIAL ANGLE BY', 'KAT PRZYBLIZONY ODBIEGAL O', &
      'AMBIGUOUS INITIAL GUESS, ANOTHER ASSEMBLY IS ABOUT AS NEAR', &
      'INNY MONTAZ JEST PODOBNIE BLISKI', 'A NEARER ASSEMBLY MAY EXIST', 'MOZE ISTNIEC BLIZSZY MONTAZ', &
      'THE MOTION BEGINS HERE', 'RUCH ZACZYNA SIE TUTAJ', &
      'REDUNDANT EQUATION', 'ROWNANIE NADLICZBOWE', 'ROWNANIA NADLICZBOWE', &
      'METHOD NEWTON FINDS A POSITION', 'METODA NEWTON ZNAJDUJE POLOZENIE', &
      '?: DIGITS LOST TO ROUNDING', '?: CYFRY UTRACONE PRZEZ ZAOKRAGLENIE', &
      'NO NUMBER IS KNOWN BETTER THAN THE CLOSURE ERROR', 'ZADNA LICZBA NIE JEST ZNANA LEPIEJ NIZ BLAD ZAMKNIECIA', &
      'LARGEST CLOSURE ERROR OF REDUNDANT EQUATIONS', 'NAJWIEKSZY BLAD ZAMKNIECIA ROWNAN NADLICZBOWYCH', &
      'REACHES THE LIMIT OF SUBSTEPS: USE SMALLER TIME STEPS', &
      'WYMAGA ZA WIELU PODKROKOW: PODAJ CHWILE BLIZSZE SIEBIE', &
      'INSTANT FLAGGED, SEE ABOVE', 'CHWILA ZAZNACZONA, PATRZ WYZEJ', &
      'RATIOS HAVE NO TOLERANCES', 'PRZELOZENIA NIE MAJA TOLERANCJI', &
      'NO CHANGE POINT WAS PASSED', 'NIE BYLO PUNKTU ZMIANY', &
      'LIMIT OR CHANGE POINT, NOT DISTINGUISHABLE (ROUNDING ERROR)', &
      'KRES LUB PUNKT ZMIANY, NIE DO ODROZNIENIA (ZAOKRAGLENIA)', &
      'NO TIME RATIO, THE RUN IS NOT A PERIOD', 'BRAK STOSUNKU CZASOW, RUCH NIE JEST OKRESEM', &
      'EXTREMES MAY BE MISSED WITHIN T =', 'EKSTREMA MOGA BYC POMINIETE W T =', &
      'NOT SEARCHED (MOTION NOT AVAILABLE): T =', 'NIE PRZESZUKANO (BRAK RUCHU): T =']

   !> What begins the line of instants without values.
   character(10), parameter :: untold(4) = [character(10) :: ' INSTANT', ' INSTANTS', ' CHWILA', ' CHWILE']

   !> An instant is flagged with it, and its time follows.
   character(50), parameter :: beyond(2) = [character(50) :: 'NO POSITION: BEYOND THE LIMIT OF MOTION AT T =', &
      'BRAK POLOZENIA: POZA KRESEM RUCHU W CHWILI T =']

contains

   !> The first thing that is wrong with the listing in `path` of so many `sets`; '' for nothing. `flagged`: steps.
   subroutine check_listing(path, sets, wrong, flagged)
      character(*), intent(in) :: path
      integer, intent(in) :: sets
      character(:), allocatable, intent(out) :: wrong
      integer, intent(out) :: flagged
      character(width) :: line, before
      integer :: unit, status, ends, i
      logical :: tables, goes_on, is_wrong, was_long
      integer :: names

      wrong = ''
      flagged = 0
      ends = 0
      tables = .false.
      goes_on = .false.
      was_long = .false.
      before = ''
      names = one_name
      open (newunit=unit, file=path, status='old', action='read', iostat=status)
      do while (status == 0)
         read (unit, '(a)', iostat=status) line
         if (status /= 0) exit
         if (len_trim(line) > longest .and. wrong == '') wrong = 'LISTING: TOO LONG: '//trim(line)
         if (goes_on) then
            if (is_sentence(line)) line = trim(before)//' '//line(6:)
            if (.not. is_sentence(line) .and. wrong == '') wrong = 'LISTING: '//trim(before)
         end if
         if (starts(line, ' INSTANT ') .or. starts(line, ' CHWILA ')) tables = .true.
         if (starts(line, ' END OF SET ') .or. starts(line, ' KONIEC KOMPLETU ')) then
            tables = .false.
            ends = ends + 1
         end if
         if (any([(starts(line, ' '//trim(other_heads(i))), i=1, size(other_heads))])) tables = .false.
         if (any(line(:8) == [character(8) :: ' POLE', ' CURVE', ' BIEGUN', ' TOR'])) then
            if (are_heads(line(two_names + 1:))) names = two_names
         else if (any(line(:12) == [character(12) :: ' RATIO', ' PRZELOZENIE'])) then
            if (are_heads(line(ratio_names + 1:))) names = ratio_names
         else if (line(:one_name) /= '' .and. line(one_name + 1:) /= '' .and. are_heads(line(one_name + 1:))) then
            names = one_name
         end if
         is_wrong = line_is_wrong(line, tables, names)
         ! The last words of a long sentence.
         if (is_wrong .and. was_long .and. is_sentence(line)) cycle
         was_long = is_sentence(line) .and. len_trim(line) > longest - longest_word
         if (is_wrong .and. is_sentence(line) .and. .not. goes_on .and. (len_trim(line) > longest - longest_word &
            .or. index(trim(line), ':', back=.true.) == len_trim(line))) then
            ! It may be a part of a long sentence, which goes on in the next line.
            before = line
            goes_on = .true.
            cycle
         end if
         goes_on = .false.
         if (tables .and. starts(line, ' *** ')) flagged = flagged + merge(0, 1, is_remark(line))
         if (index(line, ': NOT PROVED') + index(line, ': BEZ DOWODU') > 0) flagged = flagged + 1
         if (is_wrong .and. wrong == '') wrong = 'LISTING: '//trim(line)
      end do
      if (goes_on .and. wrong == '') wrong = 'LISTING: '//trim(before)
      if (ends /= sets) wrong = 'LISTING: NOT ALL SETS COME TO THEIR END'
      close (unit)
   end subroutine check_listing

   logical function line_is_wrong(line, tables, names) result(wrong)
      character(*), intent(in) :: line
      logical, intent(in) :: tables
      integer, intent(in) :: names
      integer :: i, star

      wrong = index(line, 'NaN') > 0 .or. index(line, 'Infinity') > 0
      ! Nothing that extremes are asked for moves.
      if (wrong .or. any(line == [character(12) :: '', ' AT REST', ' W SPOCZYNKU'])) return
      if (.not. tables) then
         wrong = index(line, '****') > 0
      else if (starts(line, ' *** ')) then
         wrong = all(marks /= without_links(line(6:))) .and. .not. is_remark(line)
         if (any([(starts(line(6:), trim(beyond(i))), i=1, size(beyond))])) wrong = .not. are_values(line)
      else if (is_remark(line)) then
         wrong = .false.
      else if (index(line, '   DRIVE ') + index(line, '   NAPED ') == 10) then
         ! The name of what has extremes, and the drive whose values stand below.
         wrong = index(line, ', ') == 0
      else if (index(line, 'TIME MIN TO MAX ') + index(line, 'CZAS MIN DO MAX ') > 0) then
         wrong = index(line, 'TIME RATIO') + index(line, 'STOSUNEK CZASOW') == 0
      else if (index(line, ': AS INSTANT ') + index(line, ': JAK CHWILA ') > 0) then
         ! The instants and one before them, each a whole number.
         wrong = .not. any([(starts(line, trim(untold(i))), i=1, size(untold))]) .or. &
            verify(trim(line(index(line, ':') + 13:)), '0123456789') > 0
      else if (starts(line, ' INSTANT ') .or. starts(line, ' CHWILA ') .or. index(line, ' = ') > 0) then
         wrong = .not. are_values(line)
      else if (verify(trim(adjustl(line(:12))), '0123456789.-') == 0 .and. any(line(13:13) == [' ', '*']) .and. &
         line(12:12) /= '') then
         ! A row of the table of columns begins with its time, and a star if the instant is flagged.
         star = index(line, '* ')
         wrong = .not. are_numbers(line(:max(0, star - 1))//line(star + 1:))
      else if (line(:10) == '') then
         wrong = index(line, '****') > 0
      else
         wrong = .not. (are_numbers(line(names + 1:)) .or. are_heads(line(names + 1:)))
      end if
   end function line_is_wrong

   !> The sentence `text` without the links that it names before its colon.
   pure function without_links(text) result(rest)
      character(*), intent(in) :: text
      character(len(text)) :: rest
      integer :: comma, colon

      rest = text
      comma = max(index(text, ', LINK'), index(text, ', OGNIW'))
      colon = index(text, ': ', back=.true.)
      if (comma > 0 .and. colon > 0) rest = text(:comma - 1)//text(colon:)
   end function without_links

   !> The line is a sentence behind three stars or dashes, or a part of one.
   pure logical function is_sentence(line)
      character(*), intent(in) :: line

      is_sentence = starts(line, ' *** ') .or. starts(line, ' --- ')
   end function is_sentence

   !> The line holds the words of a remark.
   pure logical function is_remark(line)
      character(*), intent(in) :: line
      integer :: i

      is_remark = .false.
      ! Rows of numbers are many, remarks are few.
      if (.not. (starts(line, ' *** ') .or. starts(line, ' --- ') .or. starts(line, ' LARGEST ') .or. starts(line, &
         ' NAJ'))) &
         return
      if (any(marks == without_links(line(6:)))) return
      ! Where a limit is.
      is_remark = (starts(line, ' *** DRIVE ') .or. starts(line, ' *** NAPED ')) .and. index(line, ' = ') > 0
      do i = 1, size(diagnostics)
         is_remark = is_remark .or. index(line, trim(diagnostics(i))) > 0
      end do
   end function is_remark

   pure logical function starts(line, text)
      character(*), intent(in) :: line, text

      starts = line(:len(text)) == text
   end function starts

   !> Only numbers, none of them a negative zero, and words for none.
   pure logical function are_numbers(text)
      character(*), intent(in) :: text
      integer :: first, last

      are_numbers = text /= ''
      last = 0
      do
         call next_word(text, first, last)
         if (first == 0) return
         associate (word => text(first:last))
            if (any(words_for_none == word)) cycle
            are_numbers = verify(word, '0123456789.E+-?') == 0 .and. scan(word, '0123456789?') > 0
            if (word(1:1) == '-') are_numbers = are_numbers .and. verify(word, '-0.?') > 0
            if (.not. are_numbers) return
         end associate
      end do
   end function are_numbers

   !> The line has the time or values of drives: a number behind each sign of equality, one at least.
   pure logical function are_values(line)
      character(*), intent(in) :: line
      integer :: first, last, at

      are_values = index(line, ' = ') > 0
      last = 0
      do while (are_values)
         at = index(line(last + 1:), ' = ')
         if (at == 0) return
         last = last + at + 2
         call next_word(line, first, last)
         are_values = first > 0
         if (are_values) are_values = are_numbers(line(first:last))
      end do
   end function are_values

   pure logical function are_heads(text)
      character(*), intent(in) :: text
      integer :: first, last

      are_heads = .true.
      last = 0
      do while (are_heads)
         call next_word(text, first, last)
         if (first == 0) return
         are_heads = any(heads == text(first:last))
      end do
   end function are_heads

   !> The word of `text` after column `last`; `first` is 0 where there is none.
   pure subroutine next_word(text, first, last)
      character(*), intent(in) :: text
      integer, intent(out) :: first
      integer, intent(inout) :: last
      integer :: start, length

      start = last + 1
      first = 0
      if (start > len(text)) return
      first = verify(text(start:), ' ')
      if (first == 0) return
      first = start + first - 1
      length = index(text(first:), ' ') - 1
      if (length < 0) length = len(text) - first + 1
      last = first + length - 1
   end subroutine next_word

   !> The same of a protocol: no number that is none, but for the missing cells of a table (`has_missing`).
   subroutine check_protocol(path, has_missing, wrong)
      character(*), intent(in) :: path
      logical, intent(in) :: has_missing
      character(:), allocatable, intent(out) :: wrong
      character(width) :: line
      integer :: unit, status

      wrong = ''
      open (newunit=unit, file=path, status='old', action='read', iostat=status)
      do while (status == 0)
         read (unit, '(a)', iostat=status) line
         if (status /= 0) exit
         if (wrong /= '') exit
         if (merge(0, index(line, 'NaN'), has_missing) + index(line, 'Infinity') + index(line, '***') > 0) &
            wrong = 'PROTOCOL: '//trim(line)
      end do
      close (unit)
   end subroutine check_protocol
end module listing_check
