!> The words of the listing, English and Polish (without diacritics).
module phrases
   implicit none
   private
   public :: phrase_t, phrase

   !> A phrase in both languages.
   type :: phrase_t
      character(160) :: english = '', polish = ''
   end type phrase_t

   ! The head of a set, its data and its structure.
   type(phrase_t), parameter, public :: &
      text_program = phrase_t('KINEMATICS OF PLANAR MECHANISMS IN MATRIX FORMULATION', &
         'KINEMATYKA MECHANIZMOW PLASKICH W UJECIU MACIERZOWYM'), &
      text_set = phrase_t('SET OF COMPUTATIONS NO.', 'KOMPLET OBLICZEN NR'), &
      text_title = phrase_t('TITLE', 'TYTUL'), &
      text_data = phrase_t('INPUT DATA', 'DANE'), &
      text_structure = phrase_t('STRUCTURE', 'STRUKTURA'), &
      text_links = phrase_t('LINKS', 'OGNIWA'), &
      text_ground = phrase_t('GROUND', 'OSTOJA'), &
      text_revolute = phrase_t('REVOLUTE PAIRS', 'PARY OBROTOWE'), &
      text_prismatic = phrase_t('PRISMATIC PAIRS', 'PARY POSTEPOWE'), &
      text_coordinates = phrase_t('COORDINATES', 'WSPOLRZEDNE'), &
      text_equations = phrase_t('EQUATIONS', 'ROWNANIA'), &
      text_degrees_of_freedom = phrase_t('DEGREES OF FREEDOM BY COUNT (13):', 'STOPNIE SWOBODY WEDLUG (13):'), &
      text_repeating = phrase_t('S IS LESS THAN THE DRIVES: IF THE MECHANISM MOVES, SO MANY EQUATIONS REPEAT OTHERS:', &
         'S JEST MNIEJSZE NIZ LICZBA NAPEDOW: PRZY RUCHU TYLE ROWNAN POWTARZA INNE:'), &
      text_drives = phrase_t('DRIVES', 'NAPEDY'), &
      text_results = phrase_t('RESULTS', 'WYNIKI'), &
      text_instant = phrase_t('INSTANT', 'CHWILA'), &
      text_link = phrase_t('LINK', 'OGNIWO'), &
      text_pair = phrase_t('PAIR', 'PARA'), &
      text_none = phrase_t('NONE', 'BRAK'), &
      text_end = phrase_t('END OF SET', 'KONIEC KOMPLETU'), &
      ! Flags of instants.
      text_flagged = phrase_t('FLAGGED', 'ZAZNACZONE'), &
      text_no_position = phrase_t('NO POSITION FOUND', 'NIE ZNALEZIONO POLOZENIA'), &
      text_singular = phrase_t('JACOBIAN SINGULAR: NO UNIQUE VELOCITIES', &
         'JAKOBIAN OSOBLIWY: BRAK JEDNOZNACZNYCH PREDKOSCI'), &
      text_change_point = phrase_t('CHANGE POINT: VELOCITIES NOT UNIQUE', 'PUNKT ZMIANY: PREDKOSCI NIEJEDNOZNACZNE'), &
      text_dead_point = phrase_t('DEAD POINT: NO FINITE VELOCITIES', 'PUNKT MARTWY: BRAK SKONCZONYCH PREDKOSCI'), &
      text_overflow = phrase_t('THE RESULT IS TOO LARGE A NUMBER', 'WYNIK JEST ZBYT DUZA LICZBA'), &
      text_groups = phrase_t('DRIVING LINKS AND ASSUR GROUPS, IN ORDER OF SOLUTION', &
         'OGNIWA NAPEDZANE I GRUPY ASSURA W KOLEJNOSCI ROZWIAZYWANIA'), &
      text_driven = phrase_t('DRIVEN', 'NAPEDZANA'), &
      text_closure_error_of = phrase_t('CLOSURE ERROR', 'BLAD ZAMKNIECIA'), &
      text_beyond = phrase_t('NO POSITION: BEYOND THE LIMIT OF MOTION AT T =', &
         'BRAK POLOZENIA: POZA KRESEM RUCHU W CHWILI T ='), &
      text_in_line = phrase_t('COLLINEAR', 'WSPOLLINIOWE'), &
      text_off_by = phrase_t('THE ASSEMBLY FOUND DIFFERS FROM THE INITIAL ANGLE BY', 'KAT PRZYBLIZONY ODBIEGAL O'), &
      text_begins = phrase_t('THE MOTION BEGINS HERE, IN THE ASSEMBLY NEAREST TO THE INITIAL GUESS', &
         'RUCH ZACZYNA SIE TUTAJ, W MONTAZU NAJBLIZSZYM PRZYBLIZENIU'), &
      text_second = phrase_t('AMBIGUOUS INITIAL GUESS, ANOTHER ASSEMBLY IS ABOUT AS NEAR', &
         'INNY MONTAZ JEST PODOBNIE BLISKI'), &
      text_incomplete = phrase_t('A NEARER ASSEMBLY MAY EXIST', 'MOZE ISTNIEC BLIZSZY MONTAZ'), &
      ! Redundant equations, and cylinders.
      text_redundant = phrase_t('REDUNDANT EQUATION', 'ROWNANIE NADLICZBOWE'), &
      text_closure_error = phrase_t('LARGEST CLOSURE ERROR OF REDUNDANT EQUATIONS, IN CHARACTERISTIC LENGTHS:', &
         'NAJWIEKSZY BLAD ZAMKNIECIA ROWNAN NADLICZBOWYCH, W DLUGOSCIACH CHARAKT.:'), &
      text_mobile = phrase_t('NOT FULLY CONSTRAINED BY THE DRIVES: DRIVE ONE OF THEM', &
         'RUCH NIEOKRESLONY, NAPEDZAJ JEDNO Z NICH'), &
      text_contradiction = phrase_t('REDUNDANT EQUATIONS ARE INCONSISTENT', 'ROWNANIA NADLICZBOWE SA SPRZECZNE'), &
      text_out_of_stroke = phrase_t('OUT OF STROKE', 'POZA SKOKIEM'), &
      text_cylinder = phrase_t('CYLINDER', 'SILOWNIK'), &
      text_length = phrase_t('LENGTH', 'DLUGOSC'), &
      text_length_0 = phrase_t('LENGTH 0, FOR A SLIDE THROUGH 0 USE PRISM', 'DLUGOSC 0, DLA SUWU PRZEZ 0 UZYJ PRISM'), &
      text_below_0 = phrase_t('ONLY LENGTHS BELOW 0, FOR A SLIDE THROUGH 0 USE PRISM', &
         'TYLKO DLUGOSCI PONIZEJ 0, DLA SUWU PRZEZ 0 UZYJ PRISM'), &
      text_drawn_stroke = phrase_t('IS DRAWN OUT OF STROKE, ITS LENGTH IS', 'JEST NARYSOWANY POZA SKOKIEM, DLUGOSC'), &
      text_shut = phrase_t('LENGTH 0', 'DLUGOSC 0'), &
      text_negative = phrase_t('ASSEMBLIES WITH A CYLINDER OF NEGATIVE LENGTH, NOT LISTED:', &
         'MONTAZE Z SILOWNIKIEM O UJEMNEJ DLUGOSCI, POMINIETE:'), &
      text_give_closing = phrase_t('FOR ROUNDED NUMBERS GIVE METHOD, REAL-2, A CLOSING TOLERANCE', &
         'DLA LICZB ZAOKRAGLONYCH PODAJ METHOD, REAL-2, TOLERANCJE ZAMKNIECIA'), &
      text_not_better = phrase_t( &
         'NO NUMBER IS KNOWN BETTER THAN THE CLOSURE ERROR, IN CHARACTERISTIC LENGTHS OR RAD:', &
         'ZADNA LICZBA NIE JEST ZNANA LEPIEJ NIZ BLAD ZAMKNIECIA, W DLUGOSCIACH CHARAKT. LUB RAD:'), &
      text_unclosed = phrase_t('DIGITS LOST TO ROUNDING OR TO THE CLOSURE ERROR', &
         'CYFRY UTRACONE PRZEZ ZAOKRAGLENIE LUB BLAD ZAMKNIECIA'), &
      ! Drives, limits and change points.
      text_surplus = phrase_t('A DRIVE IS TOO MANY, REMOVE ONE OF:', 'JEDEN NAPED JEST ZBEDNY, USUN JEDEN Z:'), &
      text_drive = phrase_t('DRIVE', 'NAPED'), &
      text_below = phrase_t('BELOW', 'PONIZEJ'), &
      text_at_limit = phrase_t('AT THE LIMIT', 'NA KRESIE RUCHU'), &
      text_change = phrase_t('CHANGE POINT AT T =', 'PUNKT ZMIANY W CHWILI T ='), &
      text_singular_at = phrase_t('SINGULAR POSITION AT T =', 'POLOZENIE OSOBLIWE W CHWILI T ='), &
      text_returns = phrase_t('RETURNS ON ITS BRANCH, CARD BRANCH SELECTS THE OTHER ONE', &
         'RUCH WRACA SWOJA GALEZIA, DRUGA WYBIERA KARTA BRANCH'), &
      text_returns_other = phrase_t('RETURNS ON THE OTHER BRANCH (CARD BRANCH)', &
         'RUCH WRACA DRUGA GALEZIA (KARTA BRANCH)'), &
      text_smoothly = phrase_t('PASSED ON THE SMOOTH BRANCH', 'RUCH PRZECHODZI GLADKO'), &
      text_flag_above = phrase_t('INSTANT FLAGGED, SEE ABOVE', 'CHWILA ZAZNACZONA, PATRZ WYZEJ'), &
      text_unknown = phrase_t('DIGITS LOST TO ROUNDING', 'CYFRY UTRACONE PRZEZ ZAOKRAGLENIE'), &
      text_way = phrase_t('THE MOTION FROM T =', 'DROGA OD CHWILI T ='), &
      text_too_long = phrase_t('REACHES THE LIMIT OF SUBSTEPS: USE SMALLER TIME STEPS', &
         'WYMAGA ZA WIELU PODKROKOW: PODAJ CHWILE BLIZSZE SIEBIE'), &
      text_turned_by = phrase_t('TURNS BY', 'OBRACA SIE O'), &
      text_in_step = phrase_t('IN THE STEP TO T =', 'W KROKU DO CHWILI T ='), &
      text_turned_far = phrase_t('ITS WHOLE TURNS ARE UNCERTAIN, USE SMALLER TIME STEPS', &
         'LICZBA OBROTOW NIEPEWNA, PODAJ CHWILE BLIZSZE SIEBIE'), &
      text_blocked = phrase_t('THE MOTION IS FOLLOWED TO T =', 'RUCH SLEDZONO DO CHWILI T ='), &
      text_close = phrase_t('LIMIT OR CHANGE POINT, NOT DISTINGUISHABLE (ROUNDING ERROR)', &
         'KRES LUB PUNKT ZMIANY, NIE DO ODROZNIENIA (ZAOKRAGLENIA)'), &
      ! Steps and branches.
      text_branch = phrase_t('BRANCH', 'GALAZ'), &
      text_continuation = phrase_t('CONTINUATION', 'KONTYNUACJA'), &
      text_certified = phrase_t('STEPS CERTIFIED', 'KROKI POTWIERDZONE'), &
      text_out_of = phrase_t('OF', 'Z'), &
      text_passed = phrase_t('CHANGE POINTS PASSED', 'PUNKTY ZMIANY'), &
      text_other = phrase_t('PASSED TO THE OTHER BRANCH (CARD BRANCH)', 'RUCH PRZECHODZI NA DRUGA GALAZ'), &
      text_not_found = phrase_t('OTHER BRANCH NOT FOUND', 'DRUGIEJ GALEZI NIE ZNALEZIONO'), &
      text_branch_from = phrase_t('FROM T =', 'OD CHWILI T =')
   ! Extremes and ranges.
   type(phrase_t), parameter, public :: &
      text_extremes = phrase_t('EXTREMES', 'EKSTREMA'), &
      text_stroke = phrase_t('STROKE', 'SKOK'), &
      text_at_drive = phrase_t('AT DRIVE', 'NAPED'), &
      text_forward = phrase_t('TIME MIN TO MAX', 'CZAS MIN DO MAX'), &
      text_return = phrase_t('TIME MAX TO MIN', 'CZAS MAX DO MIN'), &
      text_ratio = phrase_t('TIME RATIO', 'STOSUNEK CZASOW'), &
      text_no_period = phrase_t('NO TIME RATIO, THE RUN IS NOT A PERIOD: ITS ENDS DIFFER BY', &
         'BRAK STOSUNKU CZASOW, RUCH NIE JEST OKRESEM: JEGO KONCE ROZNIA SIE O'), &
      text_lengths_apart = phrase_t('CHARACTERISTIC LENGTHS', 'DLUGOSCI CHARAKT.'), &
      text_in_velocity = phrase_t('THEIR VELOCITIES', 'PREDKOSCI'), &
      text_dead_centre = phrase_t('DEAD CENTRE', 'PUNKT ZWROTNY'), &
      text_dwell = phrase_t('DWELL', 'POSTOJ'), &
      text_not_covered = phrase_t('NOT SEARCHED (MOTION NOT AVAILABLE): T =', 'NIE PRZESZUKANO (BRAK RUCHU): T ='), &
      text_may_be_missed = phrase_t('EXTREMES MAY BE MISSED WITHIN T =', 'EKSTREMA MOGA BYC POMINIETE W T ='), &
      text_range = phrase_t('RANGES OF THE DRIVES (OTHER DRIVES HELD)', 'ZAKRESY NAPEDOW (INNE NAPEDY STALE)'), &
      text_range_of_branch = phrase_t('FIRST INSTANT OUT OF REACH, RANGE OF A BRANCH', &
         'PIERWSZA CHWILA POZA ZASIEGIEM, ZAKRES GALEZI'), &
      text_all = phrase_t('TURNS FULLY, CLOSES AFTER', 'PELNY OBROT, ZAMYKA SIE PO'), &
      text_turn = phrase_t('TURN', 'OBROCIE'), &
      text_turns = phrase_t('TURNS', 'OBROTACH'), &
      text_on_the_way = phrase_t('CHANGE POINTS ON THE WAY', 'PUNKTY ZMIANY NA DRODZE'), &
      text_no_limit = phrase_t('NO LIMIT FOUND UP TO', 'KRESU NIE ZNALEZIONO DO'), &
      ! All assemblies.
      text_assemblies = phrase_t('ASSEMBLIES', 'MONTAZE'), &
      text_assembly = phrase_t('ASSEMBLY', 'MONTAZ'), &
      text_mechanism = phrase_t('INDEPENDENT MECHANISM', 'NIEZALEZNY MECHANIZM'), &
      text_block = phrase_t('BLOCK', 'BLOK'), &
      text_by = phrase_t('BY', 'WZGLEDEM'), &
      text_unknowns = phrase_t('UNKNOWNS', 'NIEWIADOME'), &
      text_paths = phrase_t('PATHS', 'SCIEZKI'), &
      text_finite = phrase_t('FINITE', 'SKONCZONE'), &
      text_at_infinity = phrase_t('AT INFINITY', 'W NIESKONCZONOSCI'), &
      text_failed = phrase_t('FAILED', 'NIEUDANE'), &
      text_partial = phrase_t('NOT OF ALL EQUATIONS', 'NIE WSZYSTKICH ROWNAN'), &
      text_real = phrase_t('REAL', 'RZECZYWISTE'), &
      text_distance = phrase_t('DISTANCE', 'ODLEGLOSC'), &
      text_determinants = phrase_t('DETERMINANTS', 'WYZNACZNIKI'), &
      text_assembly_proved = phrase_t('PROVED', 'UDOWODNIONY'), &
      text_assembly_open = phrase_t('NOT PROVED', 'NIEUDOWODNIONY'), &
      text_chosen = phrase_t('CHOSEN BY THE ESTIMATE', 'WYBRANY PRZEZ PRZYBLIZENIE'), &
      text_more_assemblies = phrase_t('THERE ARE MORE ASSEMBLIES THAN', 'MONTAZY JEST WIECEJ NIZ'), &
      text_wide_block = phrase_t('TOO MANY UNKNOWNS IN ONE BLOCK TO FIND ALL ASSEMBLIES', &
         'ZA DUZO NIEWIADOMYCH W BLOKU, BY ZNALEZC WSZYSTKIE MONTAZE'), &
      text_curve_of_assemblies = phrase_t('NON-ISOLATED SOLUTIONS, LINKS MAY MOVE WITH ALL DRIVES HELD', &
         'ROZWIAZANIA NIE SA OSOBNE, MOGA SIE RUSZAC PRZY STALYCH NAPEDACH'), &
      text_paths_failed = phrase_t('ASSEMBLIES MAY BE MISSING, HOMOTOPY PATHS FAILED:', &
         'MOZE BRAKOWAC MONTAZY: SCIEZKI BEZ KONCA:'), &
      text_first_missed = phrase_t('ASSEMBLIES MAY BE MISSING: THAT IN WHICH THE RUN BEGINS WAS NOT FOUND', &
         'MOZE BRAKOWAC MONTAZY: NIE ZNALEZIONO TEGO, W KTORYM ZACZYNA SIE RUCH'), &
      ! Tolerances.
      text_worst = phrase_t('WORST', 'NAJGOR.'), &
      text_shares = phrase_t('TOLERANCES: CONTRIBUTIONS AT THE INSTANT OF LARGEST RSS', &
         'TOLERANCJE: UDZIALY LICZB PRZY NAJWIEKSZYM RSS'), &
      text_no_shares = phrase_t('POLES AND CURVES HAVE NO TOLERANCES', 'BIEGUNY I TORY NIE MAJA TOLERANCJI'), &
      text_no_ratio_shares = phrase_t('RATIOS HAVE NO TOLERANCES', 'PRZELOZENIA NIE MAJA TOLERANCJI'), &
      text_small_shares = phrase_t('CONTRIBUTIONS BELOW 0.01 %:', 'UDZIALY PONIZEJ 0.01 %:'), &
      text_jams = phrase_t('ITS TOLERANCE BREAKS A REDUNDANT EQUATION (THE MECHANISM JAMS)', &
         'ROWNANIA NADLICZBOWE NIE DOPUSZCZAJA TOLERANCJI')
   ! Circuits.
   type(phrase_t), parameter, public :: &
      text_circuits = phrase_t('CIRCUITS AND BRANCHES', 'OBWODY I GALEZIE'), &
      text_circuit = phrase_t('CIRCUIT', 'OBWOD'), &
      text_assembly_number = phrase_t('ASSEMBLY NO.', 'MONTAZ NR'), &
      text_range_of = phrase_t('RANGE OF', 'ZAKRES'), &
      text_not_limited = phrase_t('NO LIMIT FOUND', 'KRESU NIE ZNALEZIONO'), &
      text_lost = phrase_t('NOT FOLLOWED FURTHER', 'DALEJ NIE SLEDZONO'), &
      text_branches = phrase_t('BRANCHES', 'GALEZIE'), &
      text_circuit_numbers = phrase_t('CIRCUITS', 'OBWODY'), &
      text_meet = phrase_t('MEET', 'SPOTYKAJA SIE'), &
      text_at = phrase_t('AT', 'PRZY'), &
      text_and = phrase_t('AND', 'I'), &
      text_dead_points = phrase_t('DEAD POINTS', 'PUNKTY MARTWE'), &
      text_change_points = phrase_t('CHANGE POINTS', 'PUNKTY ZMIANY'), &
      text_not_followed = phrase_t('REDUNDANT EQUATIONS: CIRCUITS ARE NOT FOLLOWED', &
         'ROWNANIA NADLICZBOWE: OBWODOW SIE NIE SLEDZI'), &
      text_more_circuits = phrase_t('MORE CIRCUITS THAN ARE FOLLOWED: THESE ARE THE FIRST', &
         'OBWODOW JEST WIECEJ, PODANO PIERWSZE'), &
      text_circuits_missing = phrase_t('CIRCUITS MAY BE MISSING: NOT ALL ASSEMBLIES ARE KNOWN', &
         'MOZE BRAKOWAC OBWODOW: NIE WSZYSTKIE MONTAZE SA ZNANE')
   ! Proofs.
   type(phrase_t), parameter, public :: &
      text_proof = phrase_t('PROOF: EXISTENCE AND UNIQUENESS IN EACH STEP, AND ERROR BOUNDS', &
         'DOWOD: ISTNIENIE I JEDNOZNACZNOSC W KAZDYM KROKU, GRANICE BLEDOW'), &
      text_parts = phrase_t('PARTS', 'CZESCI'), &
      text_tube = phrase_t('TUBE', 'RURA'), &
      text_proved = phrase_t('INSTANTS PROVED', 'CHWILE DOWIEDZIONE'), &
      text_not_proved = phrase_t('NOT PROVED', 'BEZ DOWODU'), &
      text_change_inside = phrase_t('THE STEP PASSES A CHANGE POINT', 'KROK PRZECHODZI PRZEZ PUNKT ZMIANY'), &
      text_near_singular = phrase_t('JACOBIAN TOO NEAR TO SINGULAR', 'JAKOBIAN ZBYT BLISKI OSOBLIWEMU'), &
      text_too_wide = phrase_t('BLOCK TOO LARGE, UNKNOWNS', 'BLOK ZBYT SZEROKI, NIEWIADOMYCH')
   type(phrase_t), parameter, public :: &
      text_at_rest = phrase_t('AT REST', 'W SPOCZYNKU')
   ! Remarks of instants, and pictures.
   type(phrase_t), parameter, public :: &
      text_no_change = phrase_t('NO CHANGE POINT WAS PASSED', 'NIE BYLO PUNKTU ZMIANY'), &
      text_here = phrase_t('THIS INSTANT IS AT THE CHANGE POINT', 'CHWILA LEZY W NIM'), &
      text_redundant_many = phrase_t('REDUNDANT EQUATIONS', 'ROWNANIA NADLICZBOWE'), &
      text_of_pair = phrase_t('OF PAIR', 'PARY'), &
      text_method = phrase_t('METHOD NEWTON FINDS A POSITION', 'METODA NEWTON ZNAJDUJE POLOZENIE'), &
      text_elsewhere = phrase_t('THE ITERATION ENDS AT ANOTHER ASSEMBLY', 'ITERACJA KONCZY SIE W INNYM MONTAZU'), &
      text_centre_outside = phrase_t('INSTANT CENTRE OUTSIDE', 'SRODEK CHWILOWY POZA RYSUNKIEM'), &
      text_flagged_in_all = phrase_t('FLAGGED INSTANTS IN ALL:', 'CHWILE ZAZNACZONE RAZEM:'), &
      text_position = phrase_t('POSITION', 'POLOZENIE'), &
      text_velocity = phrase_t('VELOCITY', 'PREDKOSC'), &
      text_acceleration = phrase_t('ACCELERATION', 'PRZYSPIESZENIE'), &
      ! Variants, and runs that were broken off.
      text_variant = phrase_t('VARIANT', 'WARIANT'), &
      text_variants = phrase_t('VARIANTS', 'WARIANTY'), &
      text_end_variant = phrase_t('END OF VARIANT', 'KONIEC WARIANTU'), &
      text_instants = phrase_t('INSTANTS', 'CHWILE'), &
      text_to = phrase_t('TO', 'DO'), &
      text_as = phrase_t('AS INSTANT', 'JAK CHWILA'), &
      text_are_solved = phrase_t('SOLVED', 'ROZWIAZANE'), &
      text_first_flag = phrase_t('FIRST FLAG', 'ZAZN. PIERWSZA'), &
      text_at_time = phrase_t('AT T', 'W T'), &
      text_one_range = phrase_t('RANGE', 'ZAKRES'), &
      text_whole_turns = phrase_t('REPEATS AFTER TURNS', 'OBROTY DO ZAMKNIECIA'), &
      text_broken_variant = phrase_t('THE RUN WAS BROKEN OFF AFTER VARIANT', 'OBLICZENIA PRZERWANO PO WARIANCIE'), &
      text_broken_off = phrase_t('THE RUN WAS BROKEN OFF AFTER INSTANT', 'OBLICZENIA PRZERWANO PO CHWILI'), &
      text_broken_set = phrase_t('THE RUN WAS BROKEN OFF AFTER SET', 'OBLICZENIA PRZERWANO PO KOMPLECIE')
   ! Remarks about a deck.
   type(phrase_t), parameter, public :: &
      text_card = phrase_t('CARD', 'KARTA'), &
      text_column = phrase_t('COLUMN', 'KOLUMNA'), &
      text_title_long = phrase_t('THE TITLE IS CUT AT COLUMN 80', 'TYTUL JEST OBCIETY NA KOLUMNIE 80'), &
      text_title_letters = phrase_t('THE TITLE IS PRINTED WITH ? FOR LETTERS THAT ARE NOT ASCII', &
         'W TYTULE ZNAKI SPOZA ASCII ZASTAPIONO PRZEZ ?'), &
      text_touching = phrase_t('TOUCHES THE NUMBER BEFORE IT: TWO NUMBERS ARE READ', &
         'STYKA SIE Z LICZBA PRZED NIA: CZYTANE SA DWIE'), &
      text_link_unused = phrase_t('IS A LINK WITHOUT PAIR OR DRIVE: IT COUNTS AS GROUND', &
         'OGNIWA NIE UZYWA ZADNA PARA ANI NAPED: SPOCZYWA'), &
      text_point_unused = phrase_t('IS A POINT THAT NO PAIR, DRIVE OR PRINT CARD USES', &
         'PUNKTU NIE UZYWA ZADNA PARA, NAPED ANI KARTA PRINT'), &
      text_radians = phrase_t('IS READ IN RADIANS: DID YOU MEAN DEGREES (UNITS DEG)?', &
         'TO KAT W RADIANACH: CZY MIALY BYC STOPNIE (UNITS DEG)?'), &
      text_open = phrase_t('ITS NUMBERS CONTRADICT THE DRAWING; CLOSURE ERROR THERE:', &
         'LICZBY SPRZECZNE Z RYSUNKIEM; BLAD ZAMKNIECIA NA RYSUNKU:'), &
      text_alpha = phrase_t('ALPHA FROM THE AXES OF THE LINK, AND FROM THE AXES OF THE DRAWING:', &
         'ALFA OD OSI OGNIWA I OD OSI RYSUNKU:'), &
      text_rests = phrase_t('DOES NOT MOVE WITHIN TIME: THE RATE BELONGS IN REAL-2', &
         'NIE RUSZA SIE W CZASIE RUCHU: PREDKOSC NALEZY DO REAL-2'), &
      text_rest = phrase_t('DO NOT MOVE WITHIN TIME: THE RATE BELONGS IN REAL-2', &
         'NIE RUSZAJA SIE W CZASIE RUCHU: PREDKOSC NALEZY DO REAL-2'), &
      text_fast = phrase_t('HAS A TURN OR MORE PER STEP (CHECK THE UNITS), TURNS:', &
         'MA OBROT LUB WIECEJ NA KROK (SPRAWDZ JEDNOSTKI), OBROTY:'), &
      text_jumps = phrase_t('HAS JUMPS OF ACCELERATION: VALUES AFTER THE JUMP ARE PRINTED', &
         'PRZYSPIESZENIE MA SKOKI NA STYKACH: DRUKOWANE Z PRAWEJ STRONY'), &
      text_more = phrase_t('FURTHER REMARKS:', 'DALSZYCH UWAG:')

contains

   !> Gives the text of a phrase, without trailing blanks, in Polish or in English.
   pure function phrase(words, polish) result(text)
      type(phrase_t), intent(in) :: words    !< the phrase
      logical, intent(in) :: polish          !< in Polish
      character(:), allocatable :: text

      if (polish) text = words%polish(:len_trim(words%polish))
      if (.not. polish) text = words%english(:len_trim(words%english))
   end function phrase
end module phrases
