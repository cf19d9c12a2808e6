!> Extremes of random laws of drives against closed forms in real128: one link with a RISE of each law, at rest or on
!> a constant, harmonic or table motion; fast cranks, alone or with a slider. Values and times are judged as printed.
!>
!> extremes_by_chance decks KIND FIRST COUNT: a deck with a set for each seed; KIND is rises or cranks.
!> extremes_by_chance judge KIND FIRST COUNT LISTING: the listing of that deck; the last line is `N passed, N failed`.
program extremes_by_chance
   use kinds, only: wp
   use quad_jet, only: qp, jet_t, pi_q, time_jet, operator(+), operator(-), operator(*), sqrt, sin, cos
   use rise_laws, only: rise_jet, rise_words
   use mechanism, only: term_harmonic, term_table
   use drive_laws, only: law_t, law_jet
   use dice, only: dice_t, new_dice, between, chance, throw
   use arguments, only: argument, number
   use printed_numbers, only: printed_number_t => printed_t, read_printed
   implicit none

   integer, parameter :: least = 1, greatest = 2
   character(3), parameter :: words(2) = ['MIN', 'MAX']
   real(qp), parameter :: outward(2) = [-1.0_qp, 1.0_qp]
   !> Samples of each smooth piece of a law, and steps of golden sections from there: 1E-16 of a sample.
   integer, parameter :: samples = 240, sections = 76
   real(qp), parameter :: golden = 0.618033988749894848204586834365638118_qp
   !> A place as near to the end of a piece, in lengths of that, counts as its end, from inside.
   real(qp), parameter :: inside = 1.0e-24_qp
   !> Extremes that differ by less, in the largest value or in the power of the crank's rate, are equal: either time is
   !> right. KINMAT takes the earlier one of those that differ by 2.2E-11 of that power.
   real(qp), parameter :: equal_part = 1.0e-10_qp, alike_part = 2.3e-11_qp
   !> A number may be blank if it varies by less than this, in its largest value or the power of the crank's rate.
   real(qp), parameter :: blank_part = 1.0e-8_qp
   !> A printed number is right within half of its last digit, and a hundredth for what is below; one with masked digits
   !> within one of its last known digit.
   real(qp), parameter :: half_digit = 0.51_qp, one_digit = 1.01_qp
   !> The mean number of masked digits of a value and of a time that each kind may have: as many as version 1.0 has.
   real(qp), parameter :: masked_values(2) = 0.0_qp, masked_times(2) = [0.0003_qp, 0.0792_qp]
   !> So many laws of a hundred may have a line EXTREMES MAY BE MISSED.
   integer, parameter :: max_lines = 2

   !> The motion of a link: its coordinate is a law of the drive, or that of a slider of a crank at constant speed.
   type :: scene_t
      type(law_t) :: base
      logical :: rises = .false., has_slider = .false., is_angle = .false.
      character(8) :: law = ''
      real(qp) :: start = 0.0_qp, duration = 1.0_qp, lift = 0.0_qp
      real(qp) :: crank = 1.0_qp, rod = 3.0_qp
      real(qp) :: t0 = 0.0_qp, t1 = 1.0_qp
      integer :: steps = 0
   end type scene_t

   !> Times at which a number is as large as it gets: one, or all between two.
   type :: place_t
      real(qp) :: from = 0.0_qp, to = 0.0_qp, value = 0.0_qp
   end type place_t

   !> What is printed of one set: values and times of (least:greatest, 0:2).
   type :: printed_t
      character(12) :: value(2, 0:2) = '', time(2, 0:2) = ''
      integer :: power(0:2) = 0, time_power = 0
      logical :: may_miss = .false.
   end type printed_t

   integer :: kind, first, count_of
   logical :: judges

   judges = argument(1) == 'judge'
   kind = merge(1, 2, argument(2) == 'rises')
   first = number(3)
   count_of = number(4)
   if (judges) then
      call judge_listing(argument(5))
   else
      call write_decks()
   end if

contains

   !> The scene of `seed`; all numbers are those that the deck has.
   type(scene_t) function scene_of(seed) result(s)
      integer, intent(in) :: seed
      type(dice_t) :: d

      d = new_dice(seed)
      if (kind == 1) then
         call throw_rise(d, s)
      else
         call throw_crank(d, s)
      end if
   end function scene_of

   !> A rise of 0.3 to 20 per cent of the run in 4 to 60 steps, at rest or on one of three motions.
   subroutine throw_rise(d, s)
      type(dice_t), intent(inout) :: d
      type(scene_t), intent(out) :: s
      real(wp) :: run, part
      integer :: i, rows

      run = between(d, 0.5_wp, 3.0_wp)
      s%t0 = 0.0_qp
      if (chance(d, 0.3_wp)) s%t0 = decimal(between(d, -1.0_wp, 1.0_wp))
      s%t1 = decimal(real(s%t0, wp) + run*merge(1.0_wp, -1.0_wp, chance(d, 0.8_wp)))
      s%steps = 3 + throw(d, 57)
      s%is_angle = chance(d, 0.5_wp)
      s%rises = .true.
      s%law = rise_words(throw(d, 4))
      part = 10.0_wp**between(d, log10(0.003_wp), log10(0.2_wp))
      s%duration = decimal(run*part)
      s%start = decimal(min(real(s%t0, wp), real(s%t1, wp)) + run*between(d, -0.8_wp*part, 1.0_wp - 0.2_wp*part))
      s%lift = decimal(between(d, 0.01_wp, 1.0_wp)*merge(1.0_wp, -1.0_wp, chance(d, 0.5_wp)))
      select case (throw(d, 4))
      case (1)
         if (chance(d, 0.5_wp)) s%base%polynomial(1) = decimal(between(d, -1.0_wp, 1.0_wp))
      case (2)
         s%base%polynomial(2) = decimal(between(d, -3.0_wp, 3.0_wp))
      case (3)
         s%base%form = term_harmonic
         s%base%r = [decimal(between(d, 0.01_wp, 1.0_wp)), decimal(between(d, 1.0_wp, 20.0_wp)/run), &
            decimal(between(d, -3.0_wp, 3.0_wp))]
      case (4)
         s%base%form = term_table
         rows = 2 + throw(d, 5)
         s%base%time = [(decimal(min(real(s%t0, wp), real(s%t1, wp)) - 0.01_wp + (run + 0.02_wp)*(i - 1)/(rows - 1)), &
            i=1, rows)]
         s%base%value = [(decimal(between(d, -1.0_wp, 1.0_wp)), i=1, rows)]
      end select
   end subroutine throw_rise

   !> A crank of 0 to 1000 rad/s in 5 to 24 steps: with a harmonic motion, perhaps after or during a rise; or with a
   !> slider, for up to ten turns.
   subroutine throw_crank(d, s)
      type(dice_t), intent(inout) :: d
      type(scene_t), intent(out) :: s
      real(wp) :: run, rate

      rate = between(d, 0.0_wp, 1000.0_wp)
      s%steps = 4 + throw(d, 20)
      s%base%polynomial(1:2) = [decimal(between(d, -3.0_wp, 3.0_wp)), decimal(rate)]
      s%has_slider = chance(d, 0.5_wp)
      s%is_angle = .not. s%has_slider
      if (s%has_slider) then
         s%base%polynomial(1) = 0.0_qp
         s%crank = decimal(between(d, 0.1_wp, 1.0_wp))
         s%rod = decimal(real(s%crank, wp)*between(d, 1.3_wp, 6.0_wp))
         s%t1 = decimal(2.0_wp*real(pi_q, wp)*between(d, 0.2_wp, 10.0_wp)/rate)
         return
      end if
      run = between(d, 1.0_wp, 10.0_wp)
      s%t1 = decimal(run)
      s%base%form = term_harmonic
      s%base%r = [decimal(between(d, 0.01_wp, 1.0_wp)), decimal(between(d, 0.5_wp, 5.0_wp)), &
         decimal(between(d, -3.0_wp, 3.0_wp))]
      s%rises = chance(d, 0.5_wp)
      if (.not. s%rises) return
      s%law = rise_words(throw(d, 4))
      s%duration = decimal(run*between(d, 0.01_wp, 0.5_wp))
      s%start = decimal(run*between(d, -0.5_wp, 1.0_wp))
      s%lift = decimal(between(d, -1.0_wp, 1.0_wp))
   end subroutine throw_crank

   !> `x` with seven digits.
   real(qp) function decimal(x)
      real(wp), intent(in) :: x
      character(16) :: text

      text = field(real(x, qp))
      read (text, *) decimal
   end function decimal

   !> A field of a card.
   function field(x) result(text)
      real(qp), intent(in) :: x
      character(16) :: text

      write (text, '(es14.6, 2x)') x
   end function field

   !> The coordinate of the scene and its derivatives at the time `t`.
   type(jet_t) function motion_of(s, t) result(f)
      type(scene_t), intent(in) :: s
      real(qp), intent(in) :: t

      f = law_jet(s%base, t, 1.0_qp, 1.0_qp)
      if (s%rises) f = f + rise_jet(trim(s%law), s%start, s%duration, s%lift, t, 0.0_qp)
      if (.not. s%has_slider) return
      f = s%crank*cos(f) + sqrt(s%rod**2 - s%crank*s%crank*(sin(f)*sin(f))) - (s%crank + s%rod)
   end function motion_of

   !> Derivative number `k` of `f`.
   pure real(qp) function part_of(f, k) result(x)
      type(jet_t), intent(in) :: f
      integer, intent(in) :: k

      x = merge(f%v, merge(f%d, f%dd, k == 1), k == 0)
   end function part_of

   !> The places at which the derivatives `k` of the scene are least and greatest, as a list for each of
   !> (least:greatest); `largest`: the largest size, `varies_by`: by how much it varies.
   subroutine find_extremes(s, k, which, places, largest, varies_by)
      type(scene_t), intent(in) :: s
      integer, intent(in) :: k, which
      type(place_t), allocatable, intent(out) :: places(:)
      real(qp), intent(out) :: largest, varies_by
      real(qp), allocatable :: ends(:)
      real(qp) :: f(-1:samples + 1), t(0:samples), low, high
      integer :: i, j

      ends = [min(s%t0, s%t1), max(s%t0, s%t1)]
      if (s%rises) ends = [ends, s%start, s%start + 0.5_qp*s%duration, s%start + s%duration]
      if (s%base%form == term_table) ends = [ends, s%base%time]
      if (s%has_slider) ends = [ends, (2.0_qp*pi_q*i/s%base%polynomial(2), i=0, 10)]
      ends = pack(ends, ends >= min(s%t0, s%t1) .and. ends <= max(s%t0, s%t1))
      do i = 2, size(ends)
         do j = i, 2, -1
            if (ends(j - 1) <= ends(j)) exit
            ends(j - 1:j) = [ends(j), ends(j - 1)]
         end do
      end do
      allocate (places(0))
      f([-1, samples + 1]) = -huge(f)
      low = huge(low)
      high = -huge(high)
      do i = 1, size(ends) - 1
         if (.not. ends(i + 1) > ends(i)) cycle
         do j = 0, samples
            t(j) = ends(i) + (ends(i + 1) - ends(i))*min(max(real(j, qp)/samples, inside), 1.0_qp - inside)
            f(j) = outward(which)*part_of(motion_of(s, t(j)), k)
         end do
         low = min(low, minval(f(0:samples)))
         high = max(high, maxval(f(0:samples)))
         if (maxval(f(0:samples)) - minval(f(0:samples)) <= 1.0e-9_qp*equal_part*maxval(abs(f(0:samples)))) then
            places = [places, place_t(t(0), t(samples), f(0))]
            cycle
         end if
         do j = 0, samples
            if (max(f(j - 1), f(j + 1)) > f(j)) cycle
            places = [places, peak(s, k, which, t(max(j - 1, 0)), t(min(j + 1, samples)))]
         end do
      end do
      high = max(high, maxval(places%value))
      largest = max(abs(low), abs(high))
      varies_by = high - low
      places = pack(places, places%value >= high - max(equal_part*largest, alike_part*abs(s%base%polynomial(2))**k))
      places%value = outward(which)*places%value
   end subroutine find_extremes

   !> The place between `a` and `b` at which the number is most extreme, by golden sections.
   type(place_t) function peak(s, k, which, a, b)
      type(scene_t), intent(in) :: s
      integer, intent(in) :: k, which
      real(qp), intent(in) :: a, b
      real(qp) :: t1, t2, t(2), f(2)
      integer :: i

      t1 = a
      t2 = b
      t = [t2 - golden*(t2 - t1), t1 + golden*(t2 - t1)]
      f = [(outward(which)*part_of(motion_of(s, t(i)), k), i=1, 2)]
      do i = 1, sections
         if (f(1) >= f(2)) then
            t2 = t(2)
            t(2) = t(1)
            f(2) = f(1)
            t(1) = t2 - golden*(t2 - t1)
            f(1) = outward(which)*part_of(motion_of(s, t(1)), k)
         else
            t1 = t(1)
            t(1) = t(2)
            f(1) = f(2)
            t(2) = t1 + golden*(t2 - t1)
            f(2) = outward(which)*part_of(motion_of(s, t(2)), k)
         end if
      end do
      peak = place_t(t(1), t(1), f(1))
   end function peak

   !> A deck with a set for each seed.
   subroutine write_decks()
      type(scene_t) :: s
      integer :: seed, i

      do seed = first, first + count_of - 1
         s = scene_of(seed)
         print '(a)', 'UNITS   M       RAD     S', 'GROUND  G'
         if (s%has_slider) then
            print '(a)', 'LINK    C', 'LINK    R', 'LINK    S', &
               'JOINT   O       G       C       '//field(0.0_qp)//field(0.0_qp), &
               'JOINT   A       C       R       '//field(s%crank)//field(0.0_qp)
            ! Sums of seven digits have eight.
            print '(a, f16.10, f16.1)', 'JOINT   B       S       R       ', s%crank + s%rod, 0.0
            print '(a)', 'POINT   K       G', 'PRISM   K       B       J'
            print '(a)', 'DRIVE   ANGLE   C               '//field(0.0_qp)//field(s%base%polynomial(2))
         else if (s%is_angle) then
            print '(a)', 'LINK    S', 'JOINT   O       G       S       '//field(0.0_qp)//field(0.0_qp), &
               'DRIVE   ANGLE   S               '//field(s%base%polynomial(1))//field(s%base%polynomial(2))
         else
            print '(a)', 'LINK    S', 'POINT   P       G', 'POINT   Q       S', 'PRISM   P       Q       J', &
               'DRIVE   SLIDE   J               '//field(s%base%polynomial(1))//field(s%base%polynomial(2))
         end if
         if (s%base%form == term_harmonic) &
            print '(a)', 'ADD     HARMONIC                '//field(s%base%r(1))//field(s%base%r(2))//field(s%base%r(3))
         if (s%base%form == term_table) &
            print '(a)', ('ADD     TABLE                   '//field(s%base%time(i))//field(s%base%value(i)), &
            i=1, size(s%base%time))
         if (s%rises) &
            print '(a)', 'RISE    '//s%law//'                '//field(s%start)//field(s%duration)//field(s%lift)
         print '(a, i0, t33, a)', 'TIME    ', s%steps, field(s%t0)//field(s%t1)
         print '(a)', 'EXTREMESLINKS   S', 'END'
      end do
   end subroutine write_decks

   !> Judges the tables of the listing `name`.
   subroutine judge_listing(name)
      character(*), intent(in) :: name
      type(scene_t) :: s
      type(printed_t) :: p
      integer :: unit, seed, failed, lines, numbers, masked(2), wrong(2)
      logical :: is_read

      failed = 0
      lines = 0
      numbers = 0
      masked = 0
      wrong = 0
      open (newunit=unit, file=name, status='old', action='read')
      do seed = first, first + count_of - 1
         s = scene_of(seed)
         call read_set(unit, merge(3, 1, s%is_angle), p, is_read)
         if (is_read) then
            call judge_set(seed, s, p, is_read, numbers, masked, wrong)
         else
            print '(a, i0, a)', 'FAILED: SEED ', seed, ': NO TABLE OF EXTREMES'
         end if
         if (p%may_miss) lines = lines + 1
         if (.not. is_read) failed = failed + 1
      end do
      close (unit)
      print '(a, i0, a, i0, a, i0, a, i0, a, 2f8.4)', trim(argument(2))//': numbers ', numbers, ', values wrong ', &
         wrong(1), ', times wrong ', wrong(2), ', lines MAY BE MISSED ', lines, &
         ', masked digits of a value and a time', &
         real(masked)/max(1, numbers)
      if (100*lines > max_lines*count_of) then
         print '(a)', 'FAILED: TOO MANY LINES: EXTREMES MAY BE MISSED'
         failed = failed + 1
      end if
      if (any(masked > [masked_values(kind), masked_times(kind)]*numbers)) then
         print '(a)', 'FAILED: TOO MANY MASKED DIGITS'
         failed = failed + 1
      end if
      print '(i0, a, i0, a)', count_of + 2 - failed, ' passed, ', failed, ' failed'
      if (failed > 0) stop 1
   end subroutine judge_listing

   !> Reads up to the end of a set; `column`: that of the coordinate, whose derivatives are three columns further each.
   subroutine read_set(unit, column, p, is_read)
      integer, intent(in) :: unit, column
      type(printed_t), intent(out) :: p
      logical, intent(out) :: is_read
      character(400) :: line
      character(12) :: cells(0:2)
      integer :: k, which, status, at
      logical :: on

      is_read = .false.
      on = .false.
      which = 0
      do
         read (unit, '(a)', iostat=status) line
         if (status /= 0) return
         if (line(:14) == ' EXTREMES   T ') then
            on = .true.
            at = index(line, ' 1.E')
            if (at > 0) read (line(at + 4:at + 6), *) p%time_power
            cycle
         end if
         if (index(line, 'END OF SET') > 0) exit
         if (.not. on) cycle
         if (index(line, 'MAY BE MISSED') > 0) p%may_miss = .true.
         cells = [(adjustl(line(10 + 12*(column + 3*k - 1):9 + 12*(column + 3*k))), k=0, 2)]
         if (line(:22) == '' .and. index(line, '1.E') > 0) then
            do k = 0, 2
               if (cells(k) /= '') read (cells(k)(4:), *) p%power(k)
            end do
         end if
         if (line(:6) == '  MIN ' .or. line(:6) == '  MAX ') then
            which = findloc(words, line(3:5), dim=1)
            p%value(which, :) = cells
         else if (line(:7) == '  AT T ' .and. which > 0) then
            p%time(which, :) = cells
         end if
      end do
      is_read = on
   end subroutine read_set

   !> Judges what is printed of the scene of `seed`.
   subroutine judge_set(seed, s, p, is_right, numbers, masked, wrong)
      integer, intent(in) :: seed
      type(scene_t), intent(in) :: s
      type(printed_t), intent(in) :: p
      logical, intent(out) :: is_right
      integer, intent(inout) :: numbers, masked(2), wrong(2)
      type(place_t), allocatable :: places(:)
      type(printed_number_t) :: value, time
      real(qp) :: largest, varies_by, rate
      logical :: is_wrong(2)
      integer :: k, which

      is_right = .true.
      do k = 0, 2
         rate = abs(s%base%polynomial(2))**k
         do which = least, greatest
            call find_extremes(s, k, which, places, largest, varies_by)
            is_wrong = .false.
            if (p%value(which, k) == '') then
               is_wrong(1) = varies_by > blank_part*max(largest, rate)
            else
               numbers = numbers + 1
               value = read_printed(trim(p%value(which, k)))
               time = read_printed(trim(p%time(which, k)))
               masked = masked + [value%masked, time%masked]
               is_wrong(1) = .not. is_within(value, p%power(k), places(1)%value, places(1)%value)
               is_wrong(2) = .not. any(is_within(time, p%time_power, places%from, places%to))
            end if
            if (p%may_miss) is_wrong = .false.
            wrong = wrong + merge(1, 0, is_wrong)
            is_right = is_right .and. .not. any(is_wrong)
            if (any(is_wrong)) print '(a, i0, 1x, a, i0, a, es24.14, a, es24.14)', 'FAILED: SEED ', seed, &
               words(which)//' OF DERIVATIVE ', k, ': '//trim(p%value(which, k))//' AT T = ' &
               //trim(p%time(which, k))//' BUT ', places(1)%value, ' AT ', places(1)%from
         end do
      end do
   end subroutine judge_set

   !> The printed number times 10**`power` lies between `from` and `to`, as far as its digits are known.
   elemental logical function is_within(printed, power, from, to)
      type(printed_number_t), intent(in) :: printed
      integer, intent(in) :: power
      real(qp), intent(in) :: from, to
      real(qp) :: x, allowed

      x = printed%value*10.0_qp**power
      allowed = merge(one_digit, half_digit, printed%masked > 0)*printed%unit*10.0_qp**power
      is_within = printed%valid .and. (printed%open .or. max(from - x, x - to) <= allowed)
   end function is_within
end program extremes_by_chance
