!> The words of the listing, English and Polish (without diacritics).
module phrases
   implicit none
   private
   public :: phrase_length, phrase
   public :: say_program, say_set, say_title, say_data, say_structure, say_links, say_ground, say_revolute, &
      say_prismatic, say_coordinates, say_equations, say_freedoms, say_drives, say_results, say_units, &
      say_instant, say_link, say_point, say_pair, say_phi, say_value, say_rate, say_rate2, say_none, &
      say_end, say_solved, say_marked, say_no_position, say_no_rates, say_overflow, say_card, say_default, &
      say_in_units, say_groups, say_driven, say_not_needed, &
      say_open_by, say_limit, say_in_line, say_off_by, say_second, say_redundant, say_gap, say_mobile, &
      say_contradiction, say_drive, say_below, say_at_limit, say_change, say_smoothly, &
      say_unknown, &
      say_way, say_too_long, say_branch, say_followed, say_passed, say_uncertain, say_other, &
      say_not_found, say_branch_from, say_no_change, say_here, say_idle, say_repeated, say_redundant_many, &
      say_of_pair, say_method, say_elsewhere, say_broken_off

   integer, parameter :: phrase_length = 72

   integer, parameter :: say_program = 1, say_set = 2, say_title = 3, say_data = 4, say_structure = 5, &
      say_links = 6, say_ground = 7, say_revolute = 8, say_prismatic = 9, say_coordinates = 10, &
      say_equations = 11, say_freedoms = 12, say_drives = 13, say_results = 14, say_units = 15, &
      say_instant = 16, say_link = 17, say_point = 18, say_pair = 19, say_phi = 20, say_value = 21, &
      say_rate = 22, say_rate2 = 23, say_none = 24, say_end = 25, say_solved = 26, say_marked = 27, &
      say_no_position = 28, say_no_rates = 29, say_overflow = 30, say_card = 31, say_default = 32, &
      say_in_units = 33, say_groups = 34, say_driven = 35, say_not_needed = 36, say_open_by = 37, &
      say_limit = 38, say_in_line = 39, say_off_by = 40, say_second = 41, say_redundant = 42, say_gap = 43, &
      say_mobile = 44, say_contradiction = 45, say_drive = 46, say_below = 47, say_at_limit = 48, say_change = 49, &
      say_smoothly = 50, say_unknown = 51, &
      say_way = 52, say_too_long = 53, say_branch = 54, say_followed = 55, say_passed = 56, &
      say_uncertain = 57, say_other = 58, say_not_found = 59, say_branch_from = 60, say_no_change = 61, &
      say_here = 62, say_idle = 63, say_repeated = 64, say_redundant_many = 65, say_of_pair = 66, &
      say_method = 67, say_elsewhere = 68, say_broken_off = 69

   character(phrase_length), parameter :: words(2, 69) = reshape([character(phrase_length) :: &
      'KINEMATICS OF PLANAR MECHANISMS IN MATRIX FORMULATION', &
      'KINEMATYKA MECHANIZMOW PLASKICH W UJECIU MACIERZOWYM', &
      'SET OF COMPUTATIONS NO.', 'KOMPLET OBLICZEN NR', &
      'TITLE', 'TYTUL', &
      'INPUT DATA', 'DANE', &
      'STRUCTURE', 'STRUKTURA', &
      'LINKS', 'OGNIWA', &
      'OF THEM GROUND', 'W TYM OSTOJA', &
      'REVOLUTE PAIRS', 'PARY OBROTOWE', &
      'PRISMATIC PAIRS', 'PARY POSTEPOWE', &
      'COORDINATES', 'WSPOLRZEDNE', &
      'EQUATIONS', 'ROWNANIA', &
      'FREEDOMS', 'STOPNIE SWOBODY', &
      'DRIVES', 'NAPEDY', &
      'RESULTS', 'WYNIKI', &
      'UNITS', 'JEDNOSTKI', &
      'INSTANT', 'CHWILA', &
      'LINK', 'OGNIWO', &
      'POINT', 'PUNKT', &
      'PAIR', 'PARA', &
      'PHI', 'FI', &
      'VALUE', 'WARTOSC', &
      'RATE', 'PREDKOSC', &
      '2ND RATE', 'PRZYSP.', &
      'NONE', 'BRAK', &
      'END OF SET', 'KONIEC KOMPLETU', &
      'INSTANTS SOLVED', 'CHWILE ROZWIAZANE', &
      'MARKED', 'ZAZNACZONE', &
      'NO POSITION FOUND', 'NIE ZNALEZIONO POLOZENIA', &
      'JACOBIAN SINGULAR: VELOCITIES AND ACCELERATIONS DO NOT EXIST', &
      'JAKOBIAN OSOBLIWY: PREDKOSCI I PRZYSPIESZENIA NIE ISTNIEJA', &
      'THE RESULT IS TOO LARGE A NUMBER', 'WYNIK JEST ZBYT DUZA LICZBA', &
      'CARD', 'KARTA', &
      '(DEFAULT)', '(DOMYSLNE)', &
      'UNIT', 'JEDNOSTKA', &
      'ASSUR GROUPS IN SOLVING ORDER', 'GRUPY ASSURA W KOLEJNOSCI ROZWIAZYWANIA', &
      'DRIVEN', 'NAPEDZANA', &
      'NOT NEEDED', 'ZBEDNA', &
      'STAYS OPEN BY', 'POZOSTAJE OTWARTA O', &
      'LIMIT OF MOTION AT T =', 'KRES RUCHU W CHWILI T =', &
      'AT THE LIMIT, IN LINE', 'NA KRESIE RUCHU, W JEDNEJ LINII', &
      'ROUGH ANGLE WAS OFF BY', 'KAT PRZYBLIZONY ODBIEGAL O', &
      'ANOTHER ASSEMBLY IS ABOUT AS NEAR', 'INNY MONTAZ JEST PODOBNIE BLISKI', &
      'REDUNDANT EQUATION', 'ROWNANIE NADLICZBOWE', &
      'LARGEST GAP OF REDUNDANT EQUATIONS, OF THE SIZE:', &
      'NAJWIEKSZA NIEZGODNOSC ROWNAN NADLICZBOWYCH WZGLEDEM WYMIARU:', &
      'CAN STILL MOVE, ADD A DRIVE', 'RUCH NIEOKRESLONY, DODAJ NAPED', &
      'TOO MANY EQUATIONS, AND THEY CONTRADICT ONE ANOTHER', 'ZA DUZO ROWNAN I PRZECZA SOBIE NAWZAJEM', &
      'DRIVE', 'NAPED', &
      'BELOW', 'PONIZEJ', &
      'AT THE LIMIT', 'NA KRESIE RUCHU', &
      'CHANGE POINT AT T =', 'PUNKT ZMIANY W CHWILI T =', &
      'GO ON SMOOTHLY', 'RUCH PRZECHODZI GLADKO', &
      'DIGITS THAT ROUNDING LEAVES OPEN', 'CYFRY NIEPEWNE Z POWODU ZAOKRAGLEN', &
      'THE WAY FROM T =', 'DROGA OD CHWILI T =', &
      'IS TOO LONG, ASK FOR INSTANTS NEARER TO ONE ANOTHER', 'JEST ZA DLUGA, PODAJ CHWILE BLIZSZE SIEBIE', &
      'BRANCH', 'GALAZ', &
      'INSTANTS FOLLOWED', 'CHWILE SLEDZONE', &
      'CHANGE POINTS PASSED', 'PUNKTY ZMIANY', &
      'WITHOUT CERTIFICATE', 'BEZ SWIADECTWA', &
      'TAKE THE OTHER BRANCH', 'RUCH PRZECHODZI NA DRUGA GALAZ', &
      'OTHER BRANCH NOT FOUND', 'DRUGIEJ GALEZI NIE ZNALEZIONO', &
      'FROM T =', 'OD CHWILI T =', &
      'NO CHANGE POINT WAS PASSED', 'NIE BYLO PUNKTU ZMIANY', &
      'THE INSTANT LIES ON IT', 'CHWILA LEZY W NIM', &
      'MOVES NOTHING', 'NICZEGO NIE PORUSZA', &
      'ADDS NOTHING TO THE OTHER DRIVES', 'NIE WNOSI NIC PONAD INNE NAPEDY', &
      'REDUNDANT EQUATIONS', 'ROWNANIA NADLICZBOWE', &
      'OF PAIR', 'PARY', &
      'METHOD NEWTON FINDS A POSITION', 'METODA NEWTON ZNAJDUJE POLOZENIE', &
      'THE ITERATION ENDS AT ANOTHER ASSEMBLY', 'ITERACJA KONCZY SIE W INNYM MONTAZU', &
      'THE RUN WAS BROKEN OFF AFTER INSTANT', 'OBLICZENIA PRZERWANO PO CHWILI'], [2, 69])

contains

   !> Phrase number `i`, without trailing blanks, in Polish or in English.
   pure function phrase(i, polish) result(text)
      integer, intent(in) :: i
      logical, intent(in) :: polish
      character(:), allocatable :: text

      text = trim(words(merge(2, 1, polish), i))
   end function phrase
end module phrases
