!> Mechanisms made by chance with one, two or three cylinders, against the law of cosines in real128: a boom on one
!> cylinder or on two, and a second boom on it with a cylinder of its own. `cylinders_by_chance deck COUNT [FIRST SEED]`
!> prints a deck of one set for each seed; `cylinders_by_chance check COUNT LISTING CSV [FIRST SEED]` compares what the
!> program makes of it: lengths and marks at all instants, ASSEMBLY, RANGE, CIRCUITS, and that no step crosses the
!> length 0. The last line is `N passed, N failed`.
program cylinders_by_chance
   use, intrinsic :: iso_fortran_env, only: qp => real128
   use kinds, only: wp
   use dice, only: dice_t, new_dice, between, chance, throw
   use arguments, only: argument, number
   use csv_cells, only: cells, cell_length, split, whole_text
   use test_counter, only: test_counter_t, count_one, conclude
   use printed_cards, only: card, polar
   implicit none

   real(qp), parameter :: pi = acos(-1.0_qp), turn = 2*pi
   !> Errors of a length in the CSV, and of a number that is printed with ten digits: half a unit of the last one, and
   !> the same again. Instants are farther from the limit, in parts of the run; lengths are farther from strokes.
   real(qp), parameter :: known = 1.0e-11_qp, printed = 1.0e-9_qp, apart = 1.0e-4_qp
   integer, parameter :: most = 64
   integer, parameter :: at_stroke = 1, at_zero = 2, at_dead = 3
   character(24), parameter :: words(3) = [character(24) :: 'OUT OF STROKE', 'LENGTH 0', 'AT THE LIMIT']
   !> A law is looked at so often on its way.
   integer, parameter :: samples = 2000

   !> A cylinder of a boom: its ends are `a` and `b` away from the boom's pivot, and `psi` is the angle between them.
   type :: cylinder_t
      character(16) :: foot(2) = '', eye(2) = '', stroke(2) = ''   !< as they stand on cards
      real(qp) :: a = 1.0_qp, b = 1.0_qp, psi = 1.0_qp, least = 0.0_qp, greatest = huge(1.0_qp)
      logical :: has_equal_steps = .false.                                 !< a = b: the length comes to 0
   end type cylinder_t

   !> A boom and what drives it: the angle, or the length of its first cylinder.
   type :: boom_t
      character(16) :: pivot(2) = '', rate = '', amplitude = '', frequency = ''
      logical :: by_slide = .true.
      real(qp) :: law(3) = 0.0_qp                      !< rate, amplitude and frequency
      type(cylinder_t), allocatable :: cylinders(:)
   end type boom_t

   type :: scene_t
      type(boom_t), allocatable :: booms(:)
      integer :: steps = 10
      logical :: is_clear = .true.     !< no instant is near a limit or the end of a stroke
      real(qp) :: limit = huge(1.0_qp) !< the time at which the motion ends
   end type scene_t

   !> A place where a boom stops or turns back, at the angle `rho` from its drawn position.
   type :: event_t
      real(qp) :: rho = 0.0_qp
      integer :: kind = at_dead, cylinder = 1
   end type event_t

   !> What the listing says of a set.
   type :: told_t
      integer :: negative = 0, circuits(2) = 0, branches(2) = 0
      logical :: out(most) = .false.                               !< marks of assemblies
      logical :: turns(2) = .false., circuit_turns(2) = .false.
      real(qp) :: range(2, 2) = -huge(1.0_qp), branch(2, 2, 200) = 0.0_qp
      character(120) :: words(2, 2) = ''
   end type told_t

   type(test_counter_t) :: counter
   integer :: first, count_of, i
   type(told_t), allocatable :: told(:)
   character(:), allocatable :: why

   count_of = number(2)
   if (argument(1) == 'deck') then
      first = number(3, 1)
      do i = 1, count_of
         call print_deck(new_scene(first + i - 1))
      end do
   else
      first = number(5, 1)
      call read_listing(argument(3))
      call check(argument(4))
   end if

contains

   !> The scene of a seed.
   function new_scene(seed) result(s)
      integer, intent(in) :: seed
      type(scene_t) :: s
      type(dice_t) :: d
      integer :: n, k

      d = new_dice(seed)
      do
         s = scene_t()
         n = merge(2, 1, chance(d, 0.35_wp))
         allocate (s%booms(n))
         s%steps = 4 + throw(d, 12)
         do k = 1, n
            allocate (s%booms(k)%cylinders(merge(2, 1, chance(d, 0.4_wp) .and. k == 1)))
            call throw_boom(d, k, s%booms(k))
         end do
         call find_limit(s)
         if (s%is_clear) exit
      end do
   end function new_scene

   !> Boom number `k`: one in four has a cylinder with both ends equally far from the pivot.
   subroutine throw_boom(d, k, boom)
      type(dice_t), intent(inout) :: d
      integer, intent(in) :: k
      type(boom_t), intent(inout) :: boom
      real(qp) :: pivot(2), length
      real(wp) :: swing
      integer :: j, even

      boom%pivot = ['0.0', '0.0']
      if (k == 2) boom%pivot = [text_of(between(d, 3.0_wp, 5.0_wp)), text_of(between(d, -1.0_wp, 2.0_wp))]
      read (boom%pivot, *) pivot
      boom%by_slide = chance(d, 0.6_wp) .or. k == 2
      even = throw(d, size(boom%cylinders))
      if (.not. chance(d, 0.35_wp) .or. k == 2) even = 0
      do j = 1, size(boom%cylinders)
         associate (c => boom%cylinders(j))
            do
               call throw_ends(d, pivot, j == even, c)
               if (j == 1) exit
               ! Two cylinders do not come to their limits at once.
               if (abs(sin(c%psi - boom%cylinders(1)%psi)) > 0.2_qp) exit
            end do
            length = length_of(c, 0.0_qp)
            if (chance(d, 0.5_wp)) c%stroke(1) = text_of(real(length, wp)*between(d, 0.5_wp, 0.99_wp))
            if (chance(d, 0.5_wp)) c%stroke(2) = text_of(real(length, wp)*between(d, 1.01_wp, 1.6_wp))
            if (chance(d, 0.05_wp)) c%stroke = text_of([1.1_wp, 1.3_wp]*real(length, wp))
            if (c%stroke(1) /= '') read (c%stroke(1), *) c%least
            if (c%stroke(2) /= '') read (c%stroke(2), *) c%greatest
         end associate
      end do
      swing = merge(real(length_of(boom%cylinders(1), 0.0_qp), wp), 2.0_wp, boom%by_slide)
      ! In ten seconds: slowly, or past the limit and back within few steps.
      boom%rate = text_of(0.25_wp*swing*between(d, -1.0_wp, 1.0_wp))
      if (chance(d, 0.4_wp)) then
         boom%amplitude = text_of(swing*between(d, 0.2_wp, 1.5_wp))
         boom%frequency = text_of(between(d, 0.3_wp, 2.0_wp))
         if (chance(d, 0.3_wp)) boom%frequency = text_of(between(d, 2.0_wp, 12.0_wp))
         if (chance(d, 0.5_wp)) boom%rate = '0.0'
         read (boom%amplitude, *) boom%law(2)
         read (boom%frequency, *) boom%law(3)
      end if
      read (boom%rate, *) boom%law(1)
   end subroutine throw_boom

   !> The ends of a cylinder about a pivot; `has_equal_steps`: both at one distance, by numbers of Pythagoras.
   subroutine throw_ends(d, pivot, has_equal_steps, c)
      type(dice_t), intent(inout) :: d
      real(qp), intent(in) :: pivot(2)
      logical, intent(in) :: has_equal_steps
      type(cylinder_t), intent(inout) :: c
      integer, parameter :: triples(2, 12) = reshape([5, 0, 4, 3, 3, 4, 0, 5, -3, 4, -4, 3, -5, 0, -4, -3, -3, -4, 0, -5, &
         3, -4, 4, -3], [2, 12])
      real(wp) :: foot(2), eye(2), r
      real(qp) :: f(2), e(2)

      c%has_equal_steps = has_equal_steps
      do
         if (has_equal_steps) then
            r = 0.1_wp*(3 + throw(d, 2))
            foot = r*triples(:, throw(d, 12))
            eye = r*triples(:, throw(d, 12))
         else
            foot = polar(between(d, 0.5_wp, 2.5_wp), between(d, -3.1_wp, 3.1_wp))
            eye = polar(between(d, 0.5_wp, 2.5_wp), between(d, -3.1_wp, 3.1_wp))
         end if
         c%foot = text_of(foot + real(pivot, wp))
         c%eye = text_of(eye + real(pivot, wp))
         read (c%foot, *) f
         read (c%eye, *) e
         f = f - pivot
         e = e - pivot
         c%a = norm2(f)
         c%b = norm2(e)
         c%psi = atan2(f(1)*e(2) - f(2)*e(1), dot_product(f, e))
         if (abs(sin(c%psi)) > 0.2_qp .and. (has_equal_steps .or. abs(c%a - c%b) > 0.1_qp)) exit
      end do
   end subroutine throw_ends

   !> The length of `c` when its boom has turned by `rho` from where it is drawn.
   elemental real(qp) function length_of(c, rho)
      type(cylinder_t), intent(in) :: c
      real(qp), intent(in) :: rho

      ! The same as by the cosine, and exact near 0.
      length_of = sqrt((c%a - c%b)**2 + 4*c%a*c%b*sin(0.5_qp*(c%psi + rho))**2)
   end function length_of

   !> The angle between the ends of `c` at this length, 0 to pi; outside of what the triangle allows below 0.
   real(qp) function angle_of(c, length)
      type(cylinder_t), intent(in) :: c
      real(qp), intent(in) :: length
      real(qp) :: x

      x = (c%a**2 + c%b**2 - length**2)/(2*c%a*c%b)
      angle_of = -1.0_qp
      if (abs(x) < 1.0_qp) angle_of = acos(x)
   end function angle_of

   elemental logical function is_out(c, length)
      type(cylinder_t), intent(in) :: c
      real(qp), intent(in) :: length

      is_out = length < c%least .or. length > c%greatest
   end function is_out

   !> The law of the drive of `boom` at the time `t`.
   real(qp) function law(boom, t)
      type(boom_t), intent(in) :: boom
      real(qp), intent(in) :: t

      law = boom%law(1)*t + boom%law(2)*sin(boom%law(3)*t)
      if (boom%by_slide) law = law + length_of(boom%cylinders(1), 0.0_qp)
   end function law

   !> By how much `boom` has turned at the value `x` of its drive; `exists`: there is such a position.
   subroutine turn_to(boom, x, rho, exists)
      type(boom_t), intent(in) :: boom
      real(qp), intent(in) :: x
      real(qp), intent(out) :: rho
      logical, intent(out) :: exists

      exists = .true.
      rho = x
      if (.not. boom%by_slide) return
      associate (c => boom%cylinders(1))
         rho = angle_of(c, x)
         exists = x > 0.0_qp .and. rho >= 0.0_qp
         rho = sign(rho, c%psi) - c%psi
      end associate
   end subroutine turn_to

   !> The places at which `boom` stops; with `strokes` also those at the ends of strokes.
   function events_of(boom, strokes) result(list)
      type(boom_t), intent(in) :: boom
      logical, intent(in) :: strokes
      type(event_t), allocatable :: list(:)
      real(qp) :: bounds(2), x
      integer :: j, k

      allocate (list(0))
      do j = 1, size(boom%cylinders)
         associate (c => boom%cylinders(j))
            bounds = [c%least, c%greatest]
            do k = 1, 2
               if (.not. strokes .or. c%stroke(k) == '') cycle
               x = angle_of(c, bounds(k))
               if (x >= 0.0_qp) list = [list, event_t(x - c%psi, at_stroke, j), event_t(-x - c%psi, at_stroke, j)]
            end do
            if (c%has_equal_steps) list = [list, event_t(-c%psi, at_zero, j)]
            if (j == 1 .and. boom%by_slide) then
               if (.not. c%has_equal_steps) list = [list, event_t(-c%psi, at_dead, j)]
               list = [list, event_t(pi - c%psi, at_dead, j)]
            end if
         end associate
      end do
   end function events_of

   !> Finds when the motion of `s` ends, and whether this and the ends of strokes are apart from instants.
   subroutine find_limit(s)
      type(scene_t), intent(inout) :: s
      type(event_t), allocatable :: list(:)
      real(qp) :: t, rho, from, to
      logical :: exists
      integer :: k, n, j

      do k = 1, size(s%booms)
         associate (boom => s%booms(k))
            list = events_of(boom, .false.)
            do n = 1, samples
               t = 10.0_qp*n/samples
               if (t > s%limit) exit
               if (is_beyond(boom, list, t)) then
                  from = 10.0_qp*(n - 1)/samples
                  to = t
                  do j = 1, 100
                     t = 0.5_qp*(from + to)
                     if (is_beyond(boom, list, t)) then
                        to = t
                     else
                        from = t
                     end if
                  end do
                  s%limit = min(s%limit, to)
                  exit
               end if
            end do
         end associate
      end do
      do k = 1, size(s%booms)
         associate (boom => s%booms(k))
            do n = 0, s%steps
               t = 10.0_qp*n/s%steps
               s%is_clear = s%is_clear .and. abs(t - s%limit) > apart
               if (t > s%limit) exit
               call turn_to(boom, law(boom, t), rho, exists)
               do j = 1, size(boom%cylinders)
                  associate (c => boom%cylinders(j))
                     s%is_clear = s%is_clear .and. minval(abs(length_of(c, rho) - [c%least, c%greatest])) > apart
                     ! The other way of assembly, too.
                     if (boom%by_slide) s%is_clear = s%is_clear .and. &
                        minval(abs(length_of(c, -rho - 2*boom%cylinders(1)%psi) - [c%least, c%greatest])) > apart
                  end associate
               end do
            end do
         end associate
      end do
      ! A motion that only comes near its limit is none of this test.
      do k = 1, size(s%booms)
         associate (boom => s%booms(k), c => s%booms(k)%cylinders(1))
            if (.not. boom%by_slide) cycle
            do n = 1, samples
               t = 10.0_qp*n/samples
               if (t > s%limit - 0.01_qp) exit
               rho = law(boom, t)
               s%is_clear = s%is_clear .and. (min(rho - abs(c%a - c%b), c%a + c%b - rho) > apart .or. s%limit - t < 0.2_qp)
            end do
         end associate
      end do
   end subroutine find_limit

   !> Whether `boom` is beyond one of the places of `list` at the time `t`.
   logical function is_beyond(boom, list, t)
      type(boom_t), intent(in) :: boom
      type(event_t), intent(in) :: list(:)
      real(qp), intent(in) :: t
      real(qp) :: rho, up, down
      logical :: exists

      call turn_to(boom, law(boom, t), rho, exists)
      is_beyond = .not. exists
      if (is_beyond .or. size(list) == 0) return
      call neighbours(list, up, down)
      is_beyond = rho > up .or. rho < -down
   end function is_beyond

   !> How far the next of `list` is from where the boom is drawn, upwards and downwards.
   subroutine neighbours(list, up, down, up_at, down_at)
      type(event_t), intent(in) :: list(:)
      real(qp), intent(out) :: up, down
      integer, intent(out), optional :: up_at, down_at

      up = minval(modulo(list%rho, turn))
      down = minval(modulo(-list%rho, turn))
      if (present(up_at)) up_at = minloc(modulo(list%rho, turn), dim=1)
      if (present(down_at)) down_at = minloc(modulo(-list%rho, turn), dim=1)
   end subroutine neighbours

   elemental function text_of(x) result(text)
      real(wp), intent(in) :: x
      character(16) :: text

      write (text, '(f14.4)') x
      text = adjustl(text)
   end function text_of

   !> The name of cylinder `j` of boom `k`.
   function name_of(k, j) result(name)
      integer, intent(in) :: k, j
      character(1) :: name

      write (name, '(i1)') j + 2*(k - 1)
   end function name_of

   !> Prints the set of a scene.
   subroutine print_deck(s)
      type(scene_t), intent(in) :: s
      character(1) :: id
      integer :: k, j

      call card('UNITS', 'M', 'RAD', 'S')
      call card('GROUND', 'BASE')
      do k = 1, size(s%booms)
         call card('LINK', 'BOOM'//name_of(1, k))
         do j = 1, size(s%booms(k)%cylinders)
            call card('LINK', 'BARREL'//name_of(k, j))
            call card('LINK', 'ROD'//name_of(k, j))
         end do
      end do
      do k = 1, size(s%booms)
         associate (boom => s%booms(k), under => merge('BASE    ', 'BOOM1   ', k == 1))
            call card('JOINT', 'O'//name_of(1, k), under, 'BOOM'//name_of(1, k), boom%pivot)
            do j = 1, size(boom%cylinders)
               id = name_of(k, j)
               call card('JOINT', 'F'//id, 'BARREL'//id, under, boom%cylinders(j)%foot)
               call card('JOINT', 'E'//id, 'ROD'//id, 'BOOM'//name_of(1, k), boom%cylinders(j)%eye)
               call card('CYLINDER', 'F'//id, 'E'//id, 'CYL'//id, boom%cylinders(j)%stroke)
            end do
         end associate
      end do
      do k = 1, size(s%booms)
         associate (boom => s%booms(k))
            if (boom%by_slide) call card('DRIVE', 'SLIDE', 'CYL'//name_of(k, 1), '', [character(16) :: '', boom%rate])
            if (.not. boom%by_slide) call card('DRIVE', 'ANGLE', 'BOOM1', '', [character(16) :: '', boom%rate])
            if (boom%amplitude /= '') call card('ADD', 'HARMONIC', '', '', [boom%amplitude, boom%frequency])
         end associate
      end do
      call card('TIME', whole_text(s%steps), '', '', [character(16) :: '0.0', '10.0'])
      do k = 1, size(s%booms)
         do j = 1, size(s%booms(k)%cylinders)
            call card('PRINT', 'PAIRS', 'CYL'//name_of(k, j))
         end do
      end do
      call card('RANGE', '')
      call card('ASSEMBLY', '')
      call card('CIRCUITS', '')
      print '(a)', 'END'
   end subroutine print_deck

   !> Reads what the listing in `file` says of assemblies, ranges and circuits.
   subroutine read_listing(file)
      character(*), intent(in) :: file
      character(200) :: line
      integer :: unit, status, set, k, part, at, circuit

      allocate (told(count_of))
      open (newunit=unit, file=file, status='old', action='read')
      set = 0
      part = 0
      k = 1
      do
         read (unit, '(a)', iostat=status) line
         if (status /= 0) exit
         if (index(line, ' SET OF COMPUTATIONS NO.') == 1) read (line(25:), *) set
         if (set < 1 .or. set > count_of) cycle
         associate (x => told(set))
            if (index(line, 'NEGATIVE LENGTH, NOT LISTED:') > 0) read (line(index(line, ':') + 1:), *) x%negative
            if (index(line, ' ASSEMBLY ') == 1 .and. index(line, 'DISTANCE') > 0) then
               read (line(10:), *) circuit
               x%out(circuit) = index(line, 'OUT OF STROKE') > 0
            end if
            if (index(line, ' RANGES OF THE DRIVES') == 1) part = 1
            if (index(line, ' ASSEMBLIES   T') == 1 .or. index(line, ' DEAD POINTS') == 1) part = 0
            if (index(line, ' CIRCUITS AND BRANCHES') == 1) part = 2
            if (part > 0 .and. (index(line, ' SLIDE CYL') == 1 .or. index(line, ' ANGLE BOOM') == 1 &
               .or. index(line, ' CIRCUITS AND') == 1)) k = merge(2, 1, index(line, 'CYL3') > 0)
            if (part == 1) then
               if (index(line, 'TURNS FULLY') > 0) x%turns(k) = .true.
               if (index(line, '   MIN  ') == 1) call read_range(line(9:), x%range(1, k), x%words(1, k))
               if (index(line, '   MAX  ') == 1) call read_range(line(9:), x%range(2, k), x%words(2, k))
            else if (part == 2) then
               if (scan(line(2:2), '0123456789') == 0) cycle
               read (line(2:), *) circuit
               x%circuits(k) = max(x%circuits(k), circuit)
               x%branches(k) = x%branches(k) + 1
               x%circuit_turns(k) = x%circuit_turns(k) .or. index(line, 'TURNS FULLY') > 0
               at = index(line, ' .. ')
               if (at == 0) cycle
               read (line(at + 4:), *) x%branch(2, k, x%branches(k))
               read (line(index(line(:at - 1), ' ', back=.true.):at), *) x%branch(1, k, x%branches(k))
            end if
         end associate
      end do
   end subroutine read_listing

   subroutine read_range(text, value, rest)
      character(*), intent(in) :: text
      real(qp), intent(out) :: value
      character(*), intent(out) :: rest

      read (text, *) value
      rest = text
   end subroutine read_range

   !> Compares all sets, whose CSV is in `file`.
   subroutine check(file)
      character(*), intent(in) :: file
      character(1000) :: line
      real(qp) :: at_instants(0:20, 3), at_assemblies(most, 3), value
      character(16) :: marks(0:20)
      character(cell_length) :: cell(cells)
      integer :: unit, status, set, found, step, cylinder, n

      open (newunit=unit, file=file, status='old', action='read')
      set = 0
      do
         read (unit, '(a)', iostat=status) line
         found = 0
         if (status == 0) then
            call split(line, cell, n)
            if (cell(1) == 'set') cycle
            read (cell(1), *) found
         end if
         if (found /= set) then
            if (set > 0) call check_set(set, at_instants, marks, at_assemblies)
            set = found
            at_instants = -1.0_qp
            at_assemblies = -1.0_qp
            marks = ''
            if (set == 0) exit
         end if
         if (cell(4)(:4) /= 'PAIR') cycle
         read (cell(2), *) step
         read (cell(5), '(3x, i1)') cylinder
         value = -1.0_qp
         if (cell(6) /= '') read (cell(6), *) value
         if (cell(4) == 'PAIR') then
            at_instants(step, cylinder) = value
            marks(step) = cell(15)(:16)
         else
            read (cell(4)(index(cell(4), 'ASSEMBLY') + 8:), *) n
            at_assemblies(n, cylinder) = value
         end if
      end do
      call conclude(counter)
   end subroutine check

   !> Compares set number `set` with what the CSV has of its instants and assemblies.
   subroutine check_set(set, at_instants, marks, at_assemblies)
      integer, intent(in) :: set
      real(qp), intent(in) :: at_instants(0:, :), at_assemblies(:, :)
      character(*), intent(in) :: marks(0:)
      type(scene_t) :: s

      s = new_scene(first + set - 1)
      why = ''
      call check_instants(s, at_instants, marks)
      call check_assemblies(s, told(set), at_assemblies)
      call check_ranges(s, told(set))
      call check_circuits(s, told(set))
      call count_one(counter, why == '', 'seed '//whole_text(first + set - 1)//':'//why)
   end subroutine check_set

   subroutine expect(is_so, what)
      logical, intent(in) :: is_so
      character(*), intent(in) :: what

      if (.not. is_so .and. index(why, what) == 0) why = why//' '//what
   end subroutine expect

   !> Lengths and marks before the limit, and none behind it.
   subroutine check_instants(s, found, marks)
      type(scene_t), intent(in) :: s
      real(qp), intent(in) :: found(0:, :)
      character(*), intent(in) :: marks(0:)
      real(qp) :: t, rho, length
      logical :: exists, out
      integer :: n, k, j

      do n = 0, s%steps
         t = 10.0_qp*n/s%steps
         out = .false.
         do k = 1, size(s%booms)
            call turn_to(s%booms(k), law(s%booms(k), t), rho, exists)
            do j = 1, size(s%booms(k)%cylinders)
               associate (x => found(n, j + 2*(k - 1)), c => s%booms(k)%cylinders(j))
                  if (t > s%limit) then
                     call expect(x < 0.0_qp, 'solved-behind-the-limit')
                  else
                     length = length_of(c, rho)
                     out = out .or. is_out(c, length)
                     call expect(abs(x - length) <= known, 'length')
                  end if
               end associate
            end do
         end do
         if (t < s%limit) call expect(marks(n) == merge('STROKE', '      ', out), 'mark')
         if (t > s%limit) call expect(marks(n) /= '' .and. marks(n) /= 'STROKE', 'mark-behind-the-limit')
      end do
   end subroutine check_instants

   !> All assemblies with lengths above 0, each once, by the signs of their triangles; and the number of the others.
   subroutine check_assemblies(s, x, found)
      type(scene_t), intent(in) :: s
      type(told_t), intent(in) :: x
      real(qp), intent(in) :: found(:, :)
      real(qp) :: lengths(3), rho
      logical :: out, taken(most)
      integer :: sides(2), all_real, n1, n2, k, j, n

      sides = 1
      all_real = 1
      do k = 1, size(s%booms)
         associate (boom => s%booms(k))
            if (boom%by_slide) sides(k) = 2
            ! Each length that is not given may have either sign.
            all_real = all_real*sides(k)*2**(size(boom%cylinders) - merge(1, 0, boom%by_slide))
         end associate
      end do
      call expect(x%negative == all_real - product(sides), 'negative')
      call expect(count(any(found >= 0.0_qp, dim=2)) == product(sides), 'assemblies')
      taken = .false.
      do n1 = 1, sides(1)
         do n2 = 1, sides(2)
            lengths = -1.0_qp
            out = .false.
            do k = 1, size(s%booms)
               rho = merge(0.0_qp, -2*s%booms(k)%cylinders(1)%psi, merge(n1, n2, k == 1) == 1)
               do j = 1, size(s%booms(k)%cylinders)
                  associate (c => s%booms(k)%cylinders(j), length => lengths(j + 2*(k - 1)))
                     length = length_of(c, rho)
                     out = out .or. is_out(c, length)
                  end associate
               end do
            end do
            do n = 1, most
               if (.not. taken(n) .and. all(abs(found(n, :) - lengths) <= known)) exit
            end do
            call expect(n <= most, 'an-assembly')
            if (n > most) cycle
            taken(n) = .true.
            call expect(x%out(n) .eqv. out, 'mark-of-assembly')
         end do
      end do
   end subroutine check_assemblies

   !> The value of the drive of `boom` at `rho`.
   real(qp) function value_at(boom, rho)
      type(boom_t), intent(in) :: boom
      real(qp), intent(in) :: rho

      value_at = rho
      if (boom%by_slide) value_at = length_of(boom%cylinders(1), rho)
   end function value_at

   !> Ranges end at the first stroke, length 0 or dead point.
   subroutine check_ranges(s, x)
      type(scene_t), intent(in) :: s
      type(told_t), intent(in) :: x
      type(event_t), allocatable :: list(:)
      real(qp) :: up, down, ends(2)
      integer :: k, j, at(2)

      do k = 1, size(s%booms)
         ! A range that begins out of a stroke is none of this test, nor are those of the other drive.
         do j = 1, size(s%booms)
            if (any(is_out(s%booms(j)%cylinders, length_of(s%booms(j)%cylinders, 0.0_qp)))) return
         end do
         list = events_of(s%booms(k), .true.)
         if (size(list) == 0) then
            call expect(x%turns(k), 'turns')
            cycle
         end if
         call neighbours(list, up, down, at(2), at(1))
         ends = [value_at(s%booms(k), -down), value_at(s%booms(k), up)]
         if (ends(1) > ends(2)) then
            ends = ends([2, 1])
            at = at([2, 1])
         end if
         do j = 1, 2
            call expect(abs(x%range(j, k) - ends(j)) <= printed*max(1.0_qp, abs(ends(j))), 'range')
            call expect(index(x%words(j, k), trim(words(list(at(j))%kind))) > 0, 'end-of-range')
            if (list(at(j))%kind /= at_dead) call expect( &
               index(x%words(j, k), 'CYLINDER CYL'//name_of(k, list(at(j))%cylinder)//':') > 0, 'cylinder-of-range')
         end do
      end do
   end subroutine check_ranges

   !> Circuits end at the length 0 alone; branches also at dead points. The other boom has its own assemblies on each.
   subroutine check_circuits(s, x)
      type(scene_t), intent(in) :: s
      type(told_t), intent(in) :: x
      type(event_t), allocatable :: list(:)
      real(qp) :: from, to, ends(2)
      integer :: k, n, others, j
      logical :: taken(200)

      do k = 1, size(s%booms)
         others = 1
         if (size(s%booms) == 2) others = merge(2, 1, s%booms(3 - k)%by_slide)
         list = events_of(s%booms(k), .false.)
         call expect(x%circuits(k) == others*max(1, count(list%kind == at_zero)), 'circuits')
         call expect(x%branches(k) == others*max(1, size(list)), 'branches')
         call expect(x%circuit_turns(k) .eqv. size(list) == 0, 'circuit-turns')
         taken = .false.
         do n = 1, size(list)
            from = list(n)%rho
            to = from + minval(modulo(list%rho - from, turn), modulo(list%rho - from, turn) > 1.0e-6_qp)
            if (size(list) == 1) to = from + turn
            ends = [value_at(s%booms(k), from), value_at(s%booms(k), to)]
            if (s%booms(k)%by_slide) ends = [minval(ends), maxval(ends)]
            do j = 1, x%branches(k)
               if (taken(j)) cycle
               if (.not. s%booms(k)%by_slide) ends = ends + turn*nint((x%branch(1, k, j) - ends(1))/turn)
               if (all(abs(x%branch(:, k, j) - ends) <= printed*max(1.0_qp, abs(ends)))) taken(j) = .true.
            end do
         end do
         if (size(list) > 0) call expect(count(taken) == x%branches(k), 'range-of-branch')
      end do
   end subroutine check_circuits
end program cylinders_by_chance
