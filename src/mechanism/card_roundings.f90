!> The roundings of the numbers of a deck, and of the calculation, as directions in which the motion is asked to change:
!> in each of them every number is up or down by 0.4 to 1.2 times `rounding`, by chance, and the same in every run.
module card_roundings
   use, intrinsic :: iso_fortran_env, only: int64
   use kinds, only: wp
   use mechanism, only: mechanism_t, drive_t, term_t, plane_origin, pair_prismatic, term_power, term_table, &
      term_cycloid, drive_relangle
   use drives, only: law_t, new_law, drive_motion, joint_distance
   use number_changes, only: law_change
   implicit none
   private
   public :: directions, roundings, rounding, number_point, number_pair, number_drive, number_time, &
      number_link, parts_of_number, add_own, parts_of_any, card_sizes, card_change, law_tables, drive_changes, &
      drive_bounds, largest_part, caution, own_in_tables

   !> Of eight numbers by chance the largest is seldom a small one; of four, more often.
   integer, parameter :: directions = 8
   !> Numbers that are the same on many cards have the same rounding, and a sum of many is rounded the same way again
   !> and again: in the last of the directions all cards of a kind are off alike.
   integer, parameter :: apart = directions - 2
   !> Changes are to first order: they count so many roundings, so that rows that are differences of changed motions
   !> lose no digits that matter.
   real(wp), parameter :: roundings = 256.0_wp, rounding = roundings*epsilon(1.0_wp)
   real(wp), parameter :: least = 0.4_wp, largest_part = 1.2_wp
   !> A number of the deck, and with it every sum and product, is off by half a rounding. `caution`: for how few the
   !> directions are.
   real(wp), parameter :: caution = 2.5_wp
   !> The part of the calculation's own roundings that counts in tables: a digit is worth a hundred errors of what the
   !> deck leaves open, which is the same for all programs; the program's own errors may be as large as the digit.
   real(wp), parameter :: own_in_tables = 0.01_wp

   !> What the number is on.
   integer, parameter :: number_point = 0, number_pair = 31, number_drive = 62, number_time = 93, number_link = 124

   !> Rows of numbers by chance, a prime number of them: a cubic congruence modulo the prime of Park and Miller's
   !> generator. Cards go by the first eight, all else by the last.
   integer, parameter :: rows = 251, width = 12, first_own = width - directions + 1
   integer(int64), parameter :: multiplier = 16807_int64, modulus = 2147483647_int64
   integer :: n                                !< of the loop in the next lines
   !> Written out for each number: operations on whole constant arrays of this size take the compiler seconds.
   real(wp), parameter :: parts(width, 0:rows - 1) = reshape([ &
      (sign(least + (largest_part - least)*abs(real(2_int64*mod(multiplier*int(n, int64)**3, modulus) - modulus, wp) &
      /real(modulus, wp)), real(2_int64*mod(multiplier*int(n, int64)**3, modulus) - modulus, wp)), &
      n=1, width*rows)], [width, rows])

contains

   !> The parts (directions) of `rounding` by which number `k` = 0, 1, ... of card number `card` is off. `kind`:
   !> number_point, ...
   pure function parts_of_number(kind, card, k) result(r)
      integer, intent(in) :: kind, card, k
      real(wp) :: r(directions)

      r(:apart) = parts(:apart, modulo(7*card + kind + k, rows))
      r(apart + 1:) = parts(apart + 1:directions, kind + k)
   end function parts_of_number

   !> Adds to the changes `x` (directions) the rounding of result number `k` of the calculation, of size `size_of`.
   pure subroutine add_own(size_of, k, x)
      real(wp), intent(in) :: size_of
      integer, intent(in) :: k
      real(wp), intent(inout) :: x(directions)

      if (abs(size_of) > 0.0_wp) call add_parts(rounding*abs(size_of), parts(first_own, modulo(k, rows)), x)
   end subroutine add_own

   !> Adds `times` the numbers `r` to the changes `x` (directions).
   pure subroutine add_parts(times, r, x)
      real(wp), intent(in) :: times, r(directions)
      real(wp), intent(inout) :: x(directions)

      x = x + times*r
   end subroutine add_parts

   !> The parts (directions) by which unknown `k` is off in every direction, whatever its errors come from.
   pure function parts_of_any(k) result(r)
      integer, intent(in) :: k
      real(wp) :: r(directions)

      r = parts(first_own:, modulo(k, rows))
   end function parts_of_any

   !> The sizes (points + pairs) that the roundings of points go by, along and across, since a link is turned by an
   !> angle that is rounded; and of the offsets of prismatic pairs. A place on the ground is counted from the plane's
   !> origin. `angle` (links): a sum of angles of the deck that has turned the points of each link.
   pure function card_sizes(m, angle) result(sizes)
      type(mechanism_t), intent(in) :: m
      real(wp), intent(in) :: angle(:)
      real(wp) :: sizes(size(m%points) + size(m%pairs)), origin(2)
      integer :: k

      origin = plane_origin(m)
      do k = 1, size(m%points)
         associate (link => m%links(m%points(k)%link), turned => angle(m%points(k)%link))
            sizes(k) = norm2(m%points(k)%offset)*max(1.0_wp, abs(turned))
            if (link%ground) sizes(k) = max(sizes(k), norm2(link%position(:2) - origin))
         end associate
      end do
      do k = 1, size(m%pairs)
         sizes(size(m%points) + k) = merge(abs(m%pairs(k)%offset), 0.0_wp, m%pairs(k)%kind == pair_prismatic)
      end do
   end function card_sizes

   !> The roundings (directions, 2), along and across, of point number `card` of `m` or, beyond the points, of the
   !> offset of a pair, by its size among `sizes`, see `card_sizes`; those of a place on the ground with its link's,
   !> with which all its points are off alike.
   pure function card_change(m, sizes, card) result(x)
      type(mechanism_t), intent(in) :: m
      real(wp), intent(in) :: sizes(:)
      integer, intent(in) :: card
      real(wp) :: x(directions, 2), r(directions)
      integer :: k

      do k = 1, 2
         if (card > size(m%points)) then
            r = sizes(card)*parts_of_number(number_pair, card - size(m%points), k - 1)
         else
            r = sizes(card)*parts_of_number(number_point, card, k - 1)
            associate (j => m%points(card)%link)
               if (m%links(j)%ground) r = r + abs(m%links(j)%position(k))*parts_of_number(number_link, j, k - 1)
            end associate
         end if
         x(:, k) = rounding*r
      end do
   end function card_change

   !> Of each direction and each drive the law by which the values of its tables are off, `laws`
   !> (directions, drives): a spline is linear in its values. A drive without tables has none, and neither has a
   !> mechanism without.
   subroutine law_tables(m, laws)
      type(mechanism_t), intent(in) :: m
      type(law_t), allocatable, intent(out) :: laws(:, :)
      type(drive_t) :: drive
      real(wp) :: r(directions)
      real(wp), allocatable :: sizes(:)
      integer, allocatable :: tables(:)
      integer :: i, j, k, d

      do i = 1, size(m%drives)
         if (.not. allocated(m%drives(i)%terms)) cycle
         tables = pack([(j, j=1, size(m%drives(i)%terms))], m%drives(i)%terms%kind == term_table)
         if (size(tables) == 0) cycle
         if (.not. allocated(laws)) allocate (laws(directions, size(m%drives)))
         do d = 1, directions
            drive = drive_t()
            drive%terms = m%drives(i)%terms(tables)
            do j = 1, size(drive%terms)
               sizes = table_sizes(drive%terms(j))
               do k = 1, size(sizes)
                  r = parts_of_number(number_drive, i, mod(3*j + k, 30))
                  drive%terms(j)%values(k) = rounding*r(d)*sizes(k)
               end do
            end do
            laws(d, i) = new_law(drive)
         end do
      end do
   end subroutine law_tables

   !> (rows) What the roundings of the values of a table go by: where its time is off, the value is by its slope.
   pure function table_sizes(term) result(sizes)
      type(term_t), intent(in) :: term
      real(wp) :: sizes(size(term%values)), slopes(0:size(term%values))

      associate (x => term%knots, y => term%values, n => size(term%values))
         slopes(1:n - 1) = abs((y(2:) - y(:n - 1))/(x(2:) - x(:n - 1)))
         slopes(0) = slopes(1)
         slopes(n) = slopes(n - 1)
         sizes = abs(y) + abs(x)*max(slopes(:n - 1), slopes(1:))
      end associate
   end function table_sizes

   !> The changes (directions, 0:2) at the time `t` of value, rate and acceleration of `law`, that of drive number `i`:
   !> by the numbers on its cards, by the time, and, of the calculation's own roundings the part `own`. `tables`: see
   !> `law_tables`.
   function drive_changes(law, i, t, own, tables) result(x)
      type(law_t), intent(in) :: law
      integer, intent(in) :: i
      real(wp), intent(in) :: t, own
      type(law_t), intent(in), allocatable :: tables(:, :)
      real(wp) :: x(directions, 0:2), f(0:2), r(directions)
      integer :: j, k

      x = 0.0_wp
      associate (p => law%drive%polynomial)
         do k = 1, 3
            if (abs(p(k)) > 0.0_wp .or. k == 1) call add_number(0, k, p(k))
         end do
      end associate
      do j = 1, size(law%drive%terms)
         associate (term => law%drive%terms(j))
            if (term%kind == term_table) cycle
            ! The second number of a power says what kind of function it is.
            do k = 1, merge(1, 3, term%kind == term_power)
               call add_number(j, k, term%r(k))
            end do
         end associate
      end do
      if (allocated(tables)) call add_tables(tables(:, i))
      f = drive_motion(law, t)
      do k = 0, 2
         call add_own(own*f(k), 7*i + k, x(:, k))
      end do
      f = larger(drive_motion(law, t*(1.0_wp + rounding)) - f, f - drive_motion(law, t*(1.0_wp - rounding)))
      r = parts_of_number(number_time, 0, 0) + own*parts(first_own:, number_time)
      do k = 0, 2
         if (abs(f(k)) > 0.0_wp) call add_parts(f(k), r, x(:, k))
      end do

   contains

      !> Adds what `number`, number `place` of term `term`, changes.
      subroutine add_number(term, place, number)
         integer, intent(in) :: term, place
         real(wp), intent(in) :: number
         real(wp) :: size_of
         integer :: order

         size_of = abs(number)
         ! An angle counted from another link is added to that link's, and rounded with it.
         if (term == 0 .and. place == 1 .and. law%drive%kind == drive_relangle) size_of = max(size_of, 1.0_wp)
         if (.not. size_of > 0.0_wp) return
         f = law_change_here(law%drive, term, place, t)
         r = parts_of_number(number_drive, i, mod(3*term + place, 30))
         do order = 0, 2
            if (abs(f(order)) > 0.0_wp) call add_parts(rounding*size_of*f(order), r, x(:, order))
         end do
      end subroutine add_number

      !> Adds what the `laws` (directions) of tables change.
      pure subroutine add_tables(laws)
         type(law_t), intent(in) :: laws(:)
         integer :: d

         do d = 1, size(laws)
            if (.not. allocated(laws(d)%splines)) return
            x(d, :) = x(d, :) + drive_motion(laws(d), t)
         end do
      end subroutine add_tables
   end function drive_changes

   !> Bounds (0:2) of these changes over `roundings`, with the part of the calculation's own roundings that counts in
   !> tables: for a polynomial of each number and of the time, which together are more than what the calculation rounds.
   function drive_bounds(law, i, t, tables) result(bounds)
      type(law_t), intent(in) :: law
      integer, intent(in) :: i
      real(wp), intent(in) :: t
      type(law_t), intent(in), allocatable :: tables(:, :)
      real(wp) :: bounds(0:2), x(directions, 0:2)
      integer :: k

      if (size(law%drive%terms) == 0) then
         associate (p => abs(law%drive%polynomial))
            bounds = [p(1) + 2.0_wp*abs(t)*(p(2) + abs(t)*p(3)), p(2) + 2.0_wp*abs(t)*p(3), p(3)]
            if (law%drive%kind == drive_relangle) bounds(0) = bounds(0) + 1.0_wp
         end associate
         bounds = (1.0_wp + own_in_tables)*largest_part*epsilon(1.0_wp)*bounds
      else
         x = drive_changes(law, i, t, own_in_tables, tables)
         do k = 0, 2
            bounds(k) = maxval(abs(x(:, k)))/roundings
         end do
      end if
   end function drive_bounds

   !> `law_change`; at a joint of a rise the larger of those to either side.
   function law_change_here(drive, term, place, t) result(f)
      type(drive_t), intent(in) :: drive
      integer, intent(in) :: term, place
      real(wp), intent(in) :: t
      real(wp) :: f(3), aside

      aside = 0.0_wp
      if (term > 0) then
         if (drive%terms(term)%kind >= term_cycloid) aside = joint_distance(drive%terms(term))*drive%terms(term)%r(2)
      end if
      f = law_change(drive, term, place, t + aside)
      if (aside > 0.0_wp) f = larger(f, law_change(drive, term, place, t - aside))
   end function law_change_here

   !> The one of two numbers that has the larger size.
   elemental real(wp) function larger(x, y)
      real(wp), intent(in) :: x, y

      larger = merge(x, y, abs(x) > abs(y))
   end function larger
end module card_roundings
