!> Drawings made by chance with LENGTH cards and axes along bars, against closed forms in real128: six-bars, whose joints
!> are drawn about where they are. `lengths_by_chance deck COUNT [FIRST SEED]` prints a deck of one set for each seed,
!> `lengths_by_chance check COUNT [FIRST SEED]` compares the CSV of this deck (standard input): every angle, place and
!> sensitivity to a length. The last line is `N passed, N failed`.
program lengths_by_chance
   use, intrinsic :: iso_fortran_env, only: qp => real128
   use kinds, only: wp
   use dice, only: dice_t, new_dice, between, chance, throw, disorder
   use arguments, only: argument, number
   use csv_cells, only: cells, cell_length, split, whole_text
   use test_counter, only: test_counter_t, count_one, conclude
   use printed_cards, only: card, polar
   implicit none

   !> A0, A, B, B0 and C, E, D0: crank A0 A, coupler A B C, rocker B0 B, and a dyad C E, E D0.
   integer, parameter :: a0 = 1, a = 2, b = 3, b0 = 4, c = 5, e = 6, d0 = 7, joints = 7
   character(2), parameter :: joint_names(joints) = ['A0', 'A ', 'B ', 'B0', 'C ', 'E ', 'D0']
   !> The lengths, by their ends; those of D0 are put if `d0_moves`.
   integer, parameter :: lengths = 10
   integer, parameter :: ends(2, lengths) = reshape([a0, b0, a0, a, a, b, b0, b, a, c, b, c, c, e, d0, e, a0, d0, b0, d0], &
      [2, lengths])
   !> The links with bars FROM and TO.
   integer, parameter :: links = 5
   character(8), parameter :: link_names(links) = [character(8) :: 'CRANK', 'COUPLER', 'ROCKER', 'ARM', 'LEVER']
   integer, parameter :: bars(2, links) = reshape([a0, a, a, b, b0, b, c, e, d0, e], [2, links])
   integer, parameter :: link_of(joints, 2) = reshape([0, 1, 2, 3, 2, 4, 5, 1, 2, 3, 0, 4, 5, 0], [joints, 2])
   !> Angles of bars, places of the joints and of point T of the coupler.
   integer, parameter :: values = links + 2*(joints + 1)
   !> Dead points are farther away: sines of angles between bars.
   real(wp), parameter :: least_sine = 0.35_wp
   !> Errors of a place, in parts of the largest length, and of an angle: a few roundings over the sines of three dyads.
   !> Of a sensitivity: 1E-12 over the sines of all triangles between it and the length, for each of its instants.
   real(qp), parameter :: known = 3.0e-14_qp, known_slope = 1.0e-12_qp

   type :: scene_t
      character(16) :: place(2, joints) = ''       !< as they stand on JOINT cards
      character(16) :: length(lengths) = ''        !< as they stand on LENGTH cards
      character(16) :: start = '', xi = '', eta = ''   !< the crank angle on its card; ''; as drawn
      logical :: degrees = .false., d0_moves = .false., exchanged(lengths) = .false., has_bar(links) = .true.
      real(qp) :: drawn(2, joints) = 0.0_qp, exact(lengths) = 0.0_qp, angle = 0.0_qp, t(2) = 0.0_qp
      real(qp) :: side(4) = 1.0_qp                 !< of B, C, E and D0
      integer, allocatable :: order(:)
   end type scene_t

   type(scene_t) :: scene
   type(test_counter_t) :: counter
   integer :: first, count_of, i
   real(qp) :: worst(3) = 0.0_qp, condition
   !> The row in hand: the number of its set, and its cells.
   integer :: set, step
   character(cell_length) :: cell(cells)

   count_of = number(2)
   first = number(3, 1)
   if (argument(1) == 'check') then
      call check()
      print '(3(a, es8.1))', 'LARGEST ERROR OF A VALUE ', worst(1), ', OF A SENSITIVITY ', worst(2), &
         ', OVER ITS CONDITION ', worst(3)
      call conclude(counter)
   else
      do i = 1, count_of
         scene = new_scene(first + i - 1)
         call print_deck(scene)
      end do
   end if

contains

   !> The scene of a seed: lengths with four digits, and joints drawn up to a twentieth of the mechanism away.
   function new_scene(seed) result(s)
      integer, intent(in) :: seed
      type(scene_t) :: s
      type(dice_t) :: d
      real(wp) :: p(2, joints), size_of, x
      integer :: k, j
      logical :: is_good

      d = new_dice(seed)
      do
         s = scene_t()
         s%degrees = chance(d, 0.5_wp)
         s%d0_moves = chance(d, 0.5_wp)
         size_of = 10.0_wp**throw(d, 3)
         ! A mechanism: joints that lie well apart.
         p(:, a0) = [between(d, -1.0_wp, 1.0_wp), between(d, -1.0_wp, 1.0_wp)]
         p(:, a) = p(:, a0) + polar(between(d, 0.3_wp, 0.8_wp), between(d, -3.1_wp, 3.1_wp))
         do k = b, d0
            p(:, k) = p(:, merge(a0, k - 1, k == b0 .or. k == d0)) + polar(between(d, 0.6_wp, 2.5_wp), between(d, -3.1_wp, 3.1_wp))
         end do
         p = size_of*p
         do k = 1, lengths
            write (s%length(k), '(f0.4)') norm2(p(:, ends(2, k)) - p(:, ends(1, k)))
         end do
         do k = 1, joints
            do j = 1, 2
               write (s%place(j, k), '(f14.4)') p(j, k) + merge(0.0_wp, 0.05_wp*size_of*between(d, -1.0_wp, 1.0_wp), k == a0)
            end do
         end do
         write (s%xi, '(f14.4)') size_of*between(d, -1.0_wp, 1.0_wp)
         write (s%eta, '(f14.4)') size_of*between(d, -1.0_wp, 1.0_wp)
         call read_scene(s)
         if (chance(d, 0.6_wp)) then
            x = real(s%angle, wp) + between(d, -0.05_wp, 0.05_wp)
            write (s%start, '(f14.6)') x*merge(45.0_wp/atan(1.0_wp), 1.0_wp, s%degrees)
            read (s%start, *) s%angle
            if (s%degrees) s%angle = s%angle*atan(1.0_qp)/45
         end if
         s%t = [0.0_qp, real(between(d, -0.15_wp, 0.15_wp), qp)]
         s%t(2) = nint(s%t(2)*10000)/10000.0_qp
         do k = 2, links
            s%has_bar(k) = chance(d, merge(0.9_wp, 0.7_wp, k == 2))
         end do
         do k = 1, lengths
            s%exchanged(k) = chance(d, 0.4_wp)
            s%exchanged(k) = s%exchanged(k) .and. any(k == [2, 4, 7, 8])
         end do
         ! Any order, in which no length moves what another one has used.
         s%order = disorder(d, lengths)
         s%order = [pack(s%order, s%order <= 3), pack(s%order, s%order > 3)]
         call find_sides(s, is_good)
         if (is_good .and. abs(s%t(2)) > 0.01_qp) exit
      end do
   end function new_scene

   !> Takes the numbers as they are typed.
   subroutine read_scene(s)
      type(scene_t), intent(inout) :: s
      integer :: k, j

      do k = 1, joints
         do j = 1, 2
            read (s%place(j, k), *) s%drawn(j, k)
         end do
      end do
      do k = 1, lengths
         read (s%length(k), *) s%exact(k)
      end do
      associate (way => s%drawn(:, a) - s%drawn(:, a0))
         s%angle = atan2(way(2), way(1))
      end associate
   end subroutine read_scene

   !> The sides on which joints are drawn, and whether they are clear: in the drawing and at all instants, no two bars
   !> near one line.
   subroutine find_sides(s, is_good)
      type(scene_t), intent(inout) :: s
      logical, intent(out) :: is_good
      real(qp) :: v(values), p(2, joints), q(2, joints)
      integer :: k

      q = s%drawn
      s%side(1) = side(q(:, a), q(:, b0), q(:, b))
      s%side(2) = side(q(:, a), q(:, b), q(:, c))
      s%side(3) = side(q(:, c), q(:, d0), q(:, e))
      q(:, b0) = q(:, a0) + s%exact(1)*unit(q(:, b0) - q(:, a0))
      s%side(4) = side(q(:, a0), q(:, b0), q(:, d0))
      is_good = sine(q(:, a0), q(:, b0), q(:, d0)) > least_sine .and. sine(q(:, a), q(:, b), q(:, c)) > least_sine
      do k = 0, 5
         if (.not. is_good) return
         v = motion(s, s%exact, s%t(2)*k/5, is_good)
         if (.not. is_good) return
         p = reshape(v(links + 1:links + 2*joints), [2, joints])
         is_good = sine(p(:, a), p(:, b0), p(:, b)) > least_sine .and. sine(p(:, c), p(:, d0), p(:, e)) > least_sine &
            .and. sine(q(:, a), q(:, b0), q(:, b)) > least_sine .and. sine(q(:, c), q(:, d0), q(:, e)) > least_sine
      end do
   end subroutine find_sides

   !> (values) Angles of the bars, places of the joints and of T when the crank has turned by `turn` from its start.
   function motion(s, exact, turn, exists) result(v)
      type(scene_t), intent(in) :: s
      real(qp), intent(in) :: exact(:), turn
      logical, intent(out), optional :: exists
      real(qp) :: v(values), p(2, joints), eb(2), ec(2), x
      logical :: closes(4)
      integer :: k

      p(:, a0) = s%drawn(:, a0)
      p(:, b0) = p(:, a0) + exact(1)*unit(s%drawn(:, b0) - s%drawn(:, a0))
      p(:, d0) = s%drawn(:, d0)
      closes = .true.
      if (s%d0_moves) call meet(p(:, a0), exact(9), p(:, b0), exact(10), s%side(4), p(:, d0), closes(4))
      p(:, a) = p(:, a0) + exact(2)*[cos(s%angle + turn), sin(s%angle + turn)]
      call meet(p(:, a), exact(3), p(:, b0), exact(4), s%side(1), p(:, b), closes(1))
      call meet(p(:, a), exact(5), p(:, b), exact(6), s%side(2), p(:, c), closes(2))
      call meet(p(:, c), exact(7), p(:, d0), exact(8), s%side(3), p(:, e), closes(3))
      do k = 1, links
         associate (way => p(:, bars(2, k)) - p(:, bars(1, k)))
            v(k) = atan2(way(2), way(1))
         end associate
      end do
      v(links + 1:links + 2*joints) = reshape(p, [2*joints])
      eb = unit(p(:, b) - p(:, a))
      read (s%xi, *) x
      v(values - 1:) = p(:, a) + x*eb
      read (s%eta, *) x
      ec = [-eb(2), eb(1)]
      v(values - 1:) = v(values - 1:) + x*ec
      if (present(exists)) exists = all(closes)
   end function motion

   !> The intersection `r` of two circles on a side of the line from p to q.
   subroutine meet(p, radius_p, q, radius_q, side_of, r, exists)
      real(qp), intent(in) :: p(2), radius_p, q(2), radius_q, side_of
      real(qp), intent(out) :: r(2)
      logical, intent(out) :: exists
      real(qp) :: u(2), d, along, square

      d = norm2(q - p)
      u = (q - p)/d
      along = (d**2 + radius_p**2 - radius_q**2)/(2*d)
      square = radius_p**2 - along**2
      exists = square > 0.0_qp
      r = p + along*u + sign(sqrt(max(square, 0.0_qp)), side_of)*[-u(2), u(1)]
   end subroutine meet

   function unit(v) result(u)
      real(qp), intent(in) :: v(2)
      real(qp) :: u(2)

      u = v/norm2(v)
   end function unit

   !> On which side of the line from p to q the point r is: 1 left, -1 right.
   real(qp) function side(p, q, r)
      real(qp), intent(in) :: p(2), q(2), r(2)

      side = sign(1.0_qp, (q(1) - p(1))*(r(2) - p(2)) - (q(2) - p(2))*(r(1) - p(1)))
   end function side

   !> The least |sine| of the angles of the triangle p q r.
   real(qp) function sine(p, q, r)
      real(qp), intent(in) :: p(2), q(2), r(2)
      real(qp) :: area

      area = abs((q(1) - p(1))*(r(2) - p(2)) - (q(2) - p(2))*(r(1) - p(1)))
      sine = area/maxval([norm2(q - p)*norm2(r - p), norm2(q - p)*norm2(r - q), norm2(r - p)*norm2(r - q)])
   end function sine

   !> How much the triangles of the drawing and those of the joints at `p` enlarge a rounding: one over the product of
   !> the sines.
   real(qp) function condition_of(s, p)
      type(scene_t), intent(in) :: s
      real(qp), intent(in) :: p(2, joints)

      condition_of = 1/(sine(p(:, a), p(:, b0), p(:, b))*sine(p(:, a), p(:, b), p(:, c))*sine(p(:, c), p(:, d0), p(:, e)))
      if (s%d0_moves) condition_of = condition_of/sine(p(:, a0), p(:, b0), p(:, d0))
   end function condition_of

   !> Prints the set of a scene.
   subroutine print_deck(s)
      type(scene_t), intent(in) :: s
      integer :: k, n
      character(16) :: pair(2)

      call card('UNITS', 'MM', merge('DEG', 'RAD', s%degrees), 'S')
      call card('GROUND', 'BASE')
      do k = 1, links
         if (s%has_bar(k)) call card('LINK', link_names(k), joint_names(bars(1, k)), joint_names(bars(2, k)))
         if (.not. s%has_bar(k)) call card('LINK', link_names(k))
      end do
      do k = 1, joints
         call card('JOINT', joint_names(k), name_of(link_of(k, 1)), name_of(link_of(k, 2)), s%place(:, k))
      end do
      if (s%has_bar(2)) call card('POINT', 'T', 'COUPLER', '', [s%xi, s%eta])
      do n = 1, lengths
         k = s%order(n)
         if (k > 8 .and. .not. s%d0_moves) cycle
         pair = joint_names(ends(:, k))
         if (s%exchanged(k)) pair = pair([2, 1])
         call card('LENGTH', pair(1), pair(2), '', [s%length(k)])
         call card('TOLER', '', '', '', [character(16) :: '0.1'])
      end do
      call card('DRIVE', 'ANGLE', 'CRANK', '', &
         [character(16) :: s%start, merge(text_of(45/atan(1.0_qp)), '1.0             ', s%degrees)])
      call card('AT', '', '', '', [text_of(s%t(1)), text_of(s%t(2))])
      call card('PRINT', 'LINKS')
      call card('PRINT', 'POINTS')
      print '(a)', 'END'
   end subroutine print_deck

   function name_of(link) result(name)
      integer, intent(in) :: link
      character(8) :: name

      name = 'BASE'
      if (link > 0) name = link_names(link)
   end function name_of

   function text_of(x) result(text)
      real(qp), intent(in) :: x
      character(16) :: text

      write (text, '(f15.12)') x
   end function text_of

   !> Compares the CSV on standard input with the closed forms.
   subroutine check()
      character(1000) :: line
      real(qp) :: v(values), slope(values, lengths), of_point(3, lengths), h, size_of
      integer :: status, k, j, last_set, last_step, rows

      last_set = 0
      last_step = -1
      rows = 0
      do
         read (*, '(a)', iostat=status) line
         if (status /= 0) exit
         if (line(:4) == 'set,') cycle
         call split(line, cell, k)
         read (cell(1), *) set
         read (cell(2), *) step
         if (set /= last_set) scene = new_scene(first + set - 1)
         if (set /= last_set .or. step /= last_step) then
            v = motion(scene, scene%exact, scene%t(step + 1))
            condition = condition_of(scene, reshape(v(links + 1:links + 2*joints), [2, joints]))
            do j = 1, lengths
               h = 1.0e-11_qp*scene%exact(j)
               slope(:, j) = (motion(scene, changed(j, h), scene%t(step + 1)) &
                  - motion(scene, changed(j, -h), scene%t(step + 1)))/(2*h)
            end do
         end if
         last_set = set
         last_step = step
         size_of = maxval(scene%exact)
         k = findloc(link_names, cell(5)(:8), dim=1)
         if (cell(4)(:4) == 'LINK' .and. k > 0) then
            if (.not. scene%has_bar(k)) cycle
            call compare([v(links + 2*bars(1, k) - 1:links + 2*bars(1, k)), v(k)], &
               slope([links + 2*bars(1, k) - 1, links + 2*bars(1, k), k], :), size_of)
         else if (cell(4)(:5) == 'POINT') then
            k = findloc(joint_names, cell(5)(:2), dim=1)
            if (cell(5) == 'T') k = joints + 1
            if (k == 0) cycle
            associate (at => links + 2*k - 1)
               of_point = 0.0_qp
               of_point(:2, :) = slope(at:at + 1, :)
               call compare([v(at:at + 1), 0.0_qp], of_point, size_of)
            end associate
         else
            cycle
         end if
         rows = rows + 1
      end do
      call check_that(last_set == count_of, 'sets in the CSV')
      call check_that(rows >= 100*count_of, 'rows in the CSV')
   end subroutine check

   !> Compares the row in hand: values, or sensitivities to the length that it names.
   subroutine compare(value, slopes, size_of)
      real(qp), intent(in) :: value(3), slopes(3, lengths), size_of
      real(qp) :: found(3), error(3)
      integer :: j, i
      logical :: is_slope

      is_slope = index(cell(4), ' PER LENGTH') > 0
      if (.not. is_slope .and. index(trim(cell(4)), ' ') > 0) return
      found = 0.0_qp
      do i = 1, merge(2, 3, cell(4)(:5) == 'POINT')
         read (cell(5 + i), *) found(i)
      end do
      if (scene%degrees) found(3) = found(3)*atan(1.0_qp)/45
      if (.not. is_slope) then
         error = abs(found - value)/[size_of, size_of, 1.0_qp]
         error(3) = abs(found(3) - value(3) - 8*atan(1.0_qp)*anint((found(3) - value(3))/(8*atan(1.0_qp))))
      else
         do j = 1, lengths
            if (is_named(j)) exit
         end do
         error = abs(found - slopes(:, j))/(maxval(abs(slopes(:2, j))) + 1 + abs(slopes(3, j))*size_of)*[1.0_qp, 1.0_qp, size_of]
      end if
      worst(merge(2, 1, is_slope)) = max(worst(merge(2, 1, is_slope)), maxval(error))
      if (is_slope) worst(3) = max(worst(3), maxval(error)/condition)
      associate (is_right => maxval(error) <= merge(known_slope*condition, known, is_slope))
         call check_that(is_right, trim(cell(4))//' '//trim(cell(5)))
         if (.not. is_right) print '(3es24.16)', found, merge(slopes(:, min(j, lengths)), value, is_slope), error
      end associate
   end subroutine compare

   !> Whether the row in hand is about length `j`.
   logical function is_named(j)
      integer, intent(in) :: j
      character(:), allocatable :: one, other

      one = ' PER LENGTH '//trim(joint_names(ends(1, j)))//' '//trim(joint_names(ends(2, j)))
      other = ' PER LENGTH '//trim(joint_names(ends(2, j)))//' '//trim(joint_names(ends(1, j)))
      is_named = index(trim(cell(4))//'$', one//'$') + index(trim(cell(4))//'$', other//'$') > 0
   end function is_named

   !> The lengths with number `j` changed by `h`.
   function changed(j, h) result(list)
      integer, intent(in) :: j
      real(qp), intent(in) :: h
      real(qp) :: list(lengths)

      list = scene%exact
      list(j) = list(j) + h
   end function changed

   !> Counts a check, which a failure names with its seed and step.
   subroutine check_that(is_right, words)
      logical, intent(in) :: is_right
      character(*), intent(in) :: words

      call count_one(counter, is_right, 'seed '//whole_text(first + set - 1)//' step '//whole_text(step)//': '//words)
   end subroutine check_that
end program lengths_by_chance
