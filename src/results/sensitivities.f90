!> The first-order sensitivities of the rows of a motion to the numbers that have tolerances, at one instant, and what
!> the tolerances make of them: the worst case, the sum of |s| times the tolerance, and the root of the sum of squares.
!> The linear response is that of METHOD NEWTON's blocks, whatever method has found the position. Sensitivities of the
!> same mechanism with all numbers off by roundings tell how far they are known.
module sensitivities
   use kinds, only: wp
   use planar, only: direction, turning, turning_change, dotted
   use mechanism, only: mechanism_t, tolerance_t, request_t, request_link, request_point, request_pair, &
      number_drive, pair_prismatic
   use number_changes, only: change_t, change_of, law_change, smooth_order
   use card_roundings, only: parts_of_number, number_point, number_pair, number_link, number_of_drive => number_drive, &
      rounding, roundings
   use known_digits, only: nothing_known
   use motion, only: motion_t, new_motion
   use points, only: row_t, row_of, point_motion
   use block_engine, only: block_engine_t, make_block_engine, set_drive_values, get_motion
   use link_motion, only: mark_links
   use equation_changes, only: response_t, arm_change
   use linear_response, only: make_response, respond
   implicit none
   private
   public :: sensitivities_t, sensor_t, make_sensor, find_sensitivities, has_tolerances, ground_sensitivities, &
      worst_case, root_of_squares

   !> At one instant, in the units of the rows (lengths, radians) and of the numbers on their cards.
   type :: sensitivities_t
      logical :: taken = .false.                     !< some number has a tolerance
      real(wp), allocatable :: of(:, :, :, :)        !< (3, 0:2, numbers, requests)
      real(wp), allocatable :: error(:, :, :, :)     !< likewise: what rounding leaves open of them
      integer, allocatable :: known(:)               !< (requests) as of a row: -1 none of them exists
      logical, allocatable :: jams(:)                !< (numbers) redundant equations do not allow it to change
   end type sensitivities_t

   !> Directions of roundings: of four numbers by chance the largest is seldom below a third of what it may be.
   integer, parameter :: samples = 4
   real(wp), parameter :: caution = 4.0_wp

   !> The response of a mechanism, its numbers as they are or off by roundings.
   type :: perturbed_t
      type(response_t) :: response
      type(block_engine_t), allocatable :: engine
   end type perturbed_t

   !> What an independent mechanism needs for them.
   type :: sensor_t
      type(perturbed_t), allocatable :: list(:)      !< (0:samples) number 0 has the numbers of the deck
   end type sensor_t

contains

   !> Ready for the sensitivities of `m`; nothing, where no number has a tolerance.
   subroutine make_sensor(s, m)
      type(sensor_t), intent(out) :: s
      type(mechanism_t), intent(in) :: m

      if (allocated(m%tolerances)) allocate (s%list(0:samples))
   end subroutine make_sensor

   !> `m` with its numbers off in direction `k` of roundings, if it is not 0.
   subroutine make_perturbed(s, m, k)
      type(perturbed_t), intent(inout) :: s
      type(mechanism_t), intent(in) :: m
      integer, intent(in) :: k
      type(mechanism_t) :: off
      type(change_t) :: changes(size(m%tolerances))
      integer :: i

      off = m
      if (k > 0) call put_off(off, k)
      ! One by one: of a constructed array gfortran would not free the parts.
      do i = 1, size(changes)
         changes(i) = change_of(m, m%tolerances(i))
      end do
      call make_response(s%response, off, changes)
   end subroutine make_perturbed

   !> Puts the numbers of `m` off in direction `k` of roundings.
   pure subroutine put_off(m, k)
      type(mechanism_t), intent(inout) :: m
      integer, intent(in) :: k
      integer :: i

      do i = 1, size(m%points)
         call change(m%points(i)%offset, number_point, i)
      end do
      do i = 1, size(m%pairs)
         associate (pair => m%pairs(i))
            if (pair%kind /= pair_prismatic) cycle
            call change_one(pair%alpha, number_pair, i, 0)
            call change_one(pair%offset, number_pair, i, 1)
            call change_one(pair%beta, number_pair, i, 2)
         end associate
      end do
      do i = 1, size(m%links)
         if (m%links(i)%ground) call change(m%links(i)%position, number_link, i)
      end do
      do i = 1, size(m%drives)
         call change(m%drives(i)%polynomial, number_of_drive, i)
      end do

   contains

      !> The numbers `x` of card number `card` of a kind.
      pure subroutine change(x, kind, card)
         real(wp), intent(inout) :: x(:)
         integer, intent(in) :: kind, card
         integer :: j

         do j = 1, size(x)
            call change_one(x(j), kind, card, j - 1)
         end do
      end subroutine change

      !> Number `j` = 0, 1, ... of it.
      pure subroutine change_one(x, kind, card, j)
         real(wp), intent(inout) :: x
         integer, intent(in) :: kind, card, j

         associate (part => parts_of_number(kind, card, j))
            x = x*(1.0_wp + rounding*part(k))
         end associate
      end subroutine change_one
   end subroutine put_off

   !> The sensitivities of all requests of `m` at its motion `q`, which the engine `e` has found. `in_doubt`: rounding
   !> may leave digits of them open.
   subroutine find_sensitivities(s, m, e, q, in_doubt, found)
      type(sensor_t), intent(inout) :: s
      type(mechanism_t), intent(in) :: m
      type(block_engine_t), intent(in) :: e
      type(motion_t), intent(in) :: q
      logical, intent(in) :: in_doubt
      type(sensitivities_t), intent(inout) :: found
      type(sensitivities_t) :: other
      integer :: i, k

      found%taken = allocated(m%tolerances)
      if (.not. found%taken) return
      call sense(s%list(0), 0, q%t, found)
      if (.not. allocated(found%error)) allocate (found%error, mold=found%of)
      found%error = 0.0_wp
      if (.not. in_doubt) return
      do k = 1, samples
         call sense(s%list(k), k, q%t + rounding*abs(q%t), other)
         found%error = max(found%error, caution*abs(other%of - found%of)/roundings)
         do i = 1, size(m%requests)
            if (other%known(i) < found%known(i)) found%error(:, other%known(i) + 1:, :, i) = nothing_known
         end do
      end do

   contains

      !> Those of the mechanism of `s`, off in direction `k` of roundings, at the time `t`, from the motion `q`.
      subroutine sense(s, k, t, found)
         type(perturbed_t), intent(inout) :: s
         integer, intent(in) :: k
         real(wp), intent(in) :: t
         type(sensitivities_t), intent(inout) :: found
         type(motion_t) :: again
         logical :: finite
         integer :: i, d, order

         if (.not. allocated(s%response%changes)) call make_perturbed(s, m, k)
         call take_position(s)
         call set_drive_values(s%engine, t)
         associate (m => s%response%m)
            call respond(s%response, s%engine, drive_changes(s%response%changes, t, order), q%known < 0)
            again = new_motion(size(m%links))
            again%t = t
            again%known = 2
            call get_motion(s%engine, again, finite)
            call mark_links(s%engine%chain, s%response%missing, again)
            if (.not. allocated(found%of)) then
               allocate (found%of(3, 0:2, size(m%tolerances), size(m%requests)), found%known(size(m%requests)))
            end if
            found%jams = s%response%jams
            found%of = 0.0_wp
            found%known = -1
            do i = 1, size(m%requests)
               if (.not. (has_tolerances(m, m%requests(i)) .and. exists(again, m%requests(i)))) cycle
               found%known(i) = order
               do d = 1, size(m%tolerances)
                  found%of(:, :, d, i) = row_change(m, again, m%requests(i), s%response%changes(d), &
                     s%response%links(:, :, :, d))*m%tolerances(d)%unit
               end do
            end do
         end associate
      end subroutine sense

      !> All of a row exists, in the motion `q` and in the same motion found `again`, as it must for any of its
      !> sensitivities to.
      pure logical function exists(again, request)
         type(motion_t), intent(in) :: again
         type(request_t), intent(in) :: request
         type(row_t) :: row, second

         row = row_of(m, q, request)
         second = row_of(m, again, request)
         exists = min(row%known, second%known) == 2
      end function exists

      !> Puts the engine of `s` at the position of `e`.
      subroutine take_position(s)
         type(perturbed_t), intent(inout) :: s

         if (.not. allocated(s%engine)) call prepare(s)
         s%engine%state%u = e%state%u
      end subroutine take_position

      !> Makes the engine of `s` for its mechanism.
      subroutine prepare(s)
         type(perturbed_t), intent(inout) :: s

         allocate (s%engine)
         call make_block_engine(s%engine, s%response%m)
      end subroutine prepare

      !> (0:2, drives, numbers) The changes of the laws of the drives of `m` with its numbers at the time `t`; those of
      !> values as drawn are in `bodies` (numbers). `order`: that of the highest derivatives, 0 to 2, of which this
      !> exists for all of them.
      function drive_changes(bodies, t, order) result(changes)
         type(change_t), intent(in) :: bodies(:)
         real(wp), intent(in) :: t
         integer, intent(out) :: order
         real(wp) :: changes(0:2, size(m%drives), size(m%tolerances))
         integer :: d

         changes = 0.0_wp
         order = 2
         do d = 1, size(m%tolerances)
            associate (one => m%tolerances(d))
               changes(0, :, d) = bodies(d)%drive
               if (one%kind /= number_drive) cycle
               changes(:, one%subject, d) = law_change(m%drives(one%subject), one%term, one%place, t)
               order = min(order, smooth_order(m%drives(one%subject), one%term, one%place, t))
            end associate
         end do
      end function drive_changes
   end subroutine find_sensitivities

   !> What `request` asks for has sensitivities: some number of `m` has a tolerance, and it is no pole and no curve.
   pure logical function has_tolerances(m, request)
      type(mechanism_t), intent(in) :: m
      type(request_t), intent(in) :: request

      has_tolerances = allocated(m%tolerances) .and. request%kind <= request_pair
   end function has_tolerances

   !> The change (3, 0:2) of the row of `request` of the motion `q` of `m`, where its numbers change by `change`, and
   !> its links by `links` (3, 0:2, links).
   pure function row_change(m, q, request, change, links) result(dx)
      type(mechanism_t), intent(in) :: m
      type(motion_t), intent(in) :: q
      type(request_t), intent(in) :: request
      type(change_t), intent(in) :: change
      real(wp), intent(in) :: links(:, 0:, :)
      real(wp) :: dx(3, 0:2)

      dx = 0.0_wp
      associate (i => request%subject)
         select case (request%kind)
         case (request_link)
            dx = links(:, :, i)
         case (request_point)
            dx(:2, :) = point_change(i)
         case default
            dx(1, :) = pair_change(i)
         end select
      end associate

   contains

      !> The same (2, 0:2) of point number `i`.
      pure function point_change(i) result(dx)
         integer, intent(in) :: i
         real(wp) :: dx(2, 0:2)

         associate (link => m%points(i)%link)
            dx = links(:2, :, link) + arm_change(m%points(i)%offset, change%point(:, i), angle_of(link), &
               links(3, :, link))
         end associate
      end function point_change

      !> The angle (0:2) of `link`.
      pure function angle_of(link) result(f)
         integer, intent(in) :: link
         real(wp) :: f(0:2)

         f = [m%links(link)%position(3), 0.0_wp, 0.0_wp]
         if (.not. m%links(link)%ground) f = [q%position(3, link), q%velocity(3, link), q%acceleration(3, link)]
      end function angle_of

      !> The same (0:2) of pair number `k`: phi_j - phi_i, or (Q - P) . e.
      pure function pair_change(k) result(ds)
         integer, intent(in) :: k
         real(wp) :: ds(0:2), f(0:2), df(0:2), e(2)

         associate (pair => m%pairs(k), i => m%points(m%pairs(k)%point_i)%link, j => m%points(m%pairs(k)%point_j)%link)
            ds = links(3, :, j) - links(3, :, i)
            if (pair%kind /= pair_prismatic) return
            f = angle_of(i)
            df = links(3, :, i)
            df(0) = df(0) + change%pair(1, k)
            e = direction(f(0) + pair%alpha)
            ds = dotted(point_change(pair%point_j) - point_change(pair%point_i), turning(e, f)) &
               + dotted(point_motion(m, q, pair%point_j) - point_motion(m, q, pair%point_i), &
               turning_change(e, [0.0_wp, 0.0_wp], f, df))
         end associate
      end function pair_change
   end function row_change

   !> The sensitivities (3, 0:2, numbers) of the row of the ground that `request` asks for.
   function ground_sensitivities(m, request) result(s)
      type(mechanism_t), intent(in) :: m
      type(request_t), intent(in) :: request
      real(wp), allocatable :: s(:, :, :)
      type(change_t) :: change
      real(wp) :: links(3, 0:2, size(m%links))
      type(motion_t) :: rest
      integer :: d

      allocate (s(3, 0:2, size(m%tolerances)))
      rest = new_motion(size(m%links))
      do d = 1, size(m%tolerances)
         change = change_of(m, m%tolerances(d))
         links = 0.0_wp
         links(:, 0, :) = change%ground
         s(:, :, d) = row_change(m, rest, request, change, links)*m%tolerances(d)%unit
      end do
   end function ground_sensitivities

   !> The largest change (3, 0:2) of a row with the sensitivities `s` (3, 0:2, numbers) that the `tolerances` (numbers)
   !> allow.
   pure function worst_case(tolerances, s) result(x)
      type(tolerance_t), intent(in) :: tolerances(:)
      real(wp), intent(in) :: s(:, 0:, :)
      real(wp) :: x(3, 0:2)
      integer :: d

      x = 0.0_wp
      do d = 1, size(tolerances)
         x = x + abs(s(:, :, d))*tolerances(d)%size_of
      end do
   end function worst_case

   !> The root (3, 0:2) of the sum of the squares of its changes by one tolerance at a time.
   pure function root_of_squares(tolerances, s) result(x)
      type(tolerance_t), intent(in) :: tolerances(:)
      real(wp), intent(in) :: s(:, 0:, :)
      real(wp) :: x(3, 0:2)
      integer :: c, k

      do k = 0, 2
         do c = 1, 3
            x(c, k) = norm2(s(c, k, :)*tolerances%size_of)
         end do
      end do
   end function root_of_squares
end module sensitivities
