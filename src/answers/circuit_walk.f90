!> A circuit of a mechanism with several components: all of them move with the drive until the first one comes to the
!> end of its branch. At a dead point that one goes on along its next branch, and all others turn back.
module circuit_walk
   use kinds, only: wp
   use planar, only: pi
   use circuit_components, only: component_t, circuit_position_t, same_value
   use circuit_trace, only: end_closed
   implicit none
   private
   public :: leg_t, walk_t, walk, is_on

   !> A circuit has no more pieces.
   integer, parameter :: max_legs = 10000

   !> A piece of a circuit between two turns of the drive.
   type :: leg_t
      type(circuit_position_t) :: low                       !< its end at the least value of the drive
      real(wp) :: length = 0.0_wp                !< of the drive's way
      integer :: way = 1                         !< the sense of the circuit: 1 upwards
      integer :: by(2) = 0                       !< the component that ends it at the least and the greatest value
   end type leg_t

   type :: walk_t
      type(leg_t), allocatable :: legs(:)
      integer :: ends(2) = end_closed
   end type walk_t

contains

   !> The circuit `one` through `start`. `ok`: never do two components come to dead points together.
   subroutine walk(c, start, one, ok)
      type(component_t), intent(in) :: c(:)
      type(circuit_position_t), intent(in) :: start
      type(walk_t), intent(out) :: one
      logical, intent(out) :: ok
      type(circuit_position_t) :: s, at_end
      type(walk_t) :: back
      integer :: way, by, first_by

      s = start
      way = 1
      allocate (one%legs(0))
      call run(c, s, way, by, ok)
      if (.not. ok) return
      if (by == 0) then
         one%legs = [leg_t(low=start, length=common_period(c, start%branch))]
         return
      end if
      at_end = s
      first_by = by
      call go_on(at_end, 1, first_by, one)
      if (all(one%ends == end_closed) .or. .not. ok) return
      call go_on(at_end, 0, first_by, back)
      if (.not. ok) return
      back%legs = back%legs(size(back%legs):1:-1)
      back%legs%way = -back%legs%way
      one%legs = [back%legs, one%legs]
      one%ends(1) = back%ends(2)

   contains

      !> The legs of `w` from the state `from` at the end of an upward one, which component `begun_by` has ended: beyond
      !> the dead point if `turn` is 1, back along that leg if it is 0. They end where the first begins, or at an end.
      subroutine go_on(from, turn, begun_by, w)
         type(circuit_position_t), intent(in) :: from
         integer, intent(in) :: turn, begun_by
         type(walk_t), intent(inout) :: w
         type(circuit_position_t) :: s, first
         type(leg_t) :: leg
         integer :: way, side, by, ended_by

         if (.not. allocated(w%legs)) allocate (w%legs(0))
         w%ends = 0
         s = from
         by = begun_by
         way = -1
         if (turn == 1) then
            if (c(by)%next(2, s%branch(by)) == 0) then
               w%ends(2) = end_of(c(by), s%branch(by), 2)
               return
            end if
            call turn_back(c(by), 2, s%branch(by), s%value(by))
         end if
         first = s
         do
            leg%way = way
            side = merge(2, 1, way > 0)
            leg%by(3 - side) = by
            leg%low = s
            call run(c, s, way, ended_by, ok)
            ok = ok .and. ended_by > 0 .and. size(w%legs) < max_legs
            if (.not. ok) return
            leg%length = abs(s%value(1) - leg%low%value(1))
            if (way < 0) leg%low = s
            by = ended_by
            leg%by(side) = by
            w%legs = [w%legs, leg]
            if (c(by)%next(side, s%branch(by)) == 0) then
               w%ends(2) = end_of(c(by), s%branch(by), side)
               return
            end if
            call turn_back(c(by), side, s%branch(by), s%value(by))
            way = -way
            if (way < 0 .and. turn == 1 .and. is_same(c, s, first)) then
               w%ends = end_closed
               return
            end if
         end do
      end subroutine go_on
   end subroutine walk

   !> Moves `s` in the sense `way` to the first end of a branch, that of component `by`; 0: none has one. `ok`: the next
   !> one does not end there too.
   subroutine run(c, s, way, by, ok)
      type(component_t), intent(in) :: c(:)
      type(circuit_position_t), intent(inout) :: s
      integer, intent(in) :: way
      integer, intent(out) :: by
      logical, intent(out) :: ok
      real(wp) :: room(size(c))
      integer :: i

      do i = 1, size(c)
         room(i) = huge(1.0_wp)
         if (c(i)%period(s%branch(i)) <= 0.0_wp) &
            room(i) = abs(c(i)%ends(merge(2, 1, way > 0), s%branch(i)) - s%value(i))
      end do
      by = minloc(room, dim=1)
      ok = .true.
      if (room(by) >= huge(1.0_wp)) then
         by = 0
         return
      end if
      ok = count(room < room(by) + same_value) == 1
      s%value = s%value + way*room(by)
   end subroutine run

   !> At the dead point of component `c` on this `side` of its `branch` the next branch begins, with its `value`.
   pure subroutine turn_back(c, side, branch, value)
      type(component_t), intent(in) :: c
      integer, intent(in) :: side
      integer, intent(inout) :: branch
      real(wp), intent(inout) :: value

      branch = c%next(side, branch)
      value = c%ends(side, branch)
   end subroutine turn_back

   !> How branch `b` of component `c` ends on this `side`, where it has no dead point.
   pure integer function end_of(c, b, side)
      type(component_t), intent(in) :: c
      integer, intent(in) :: b, side
      logical :: rises

      associate (branch => c%found%branches(b), circuit => c%found%list(c%found%branches(b)%circuit))
         rises = circuit%points(branch%first)%value(0) < circuit%points(branch%last)%value(0)
         end_of = circuit%ends(merge(side, 3 - side, rises))
      end associate
   end function end_of

   !> The states `a` and `b` are one.
   pure logical function is_same(c, a, b)
      type(component_t), intent(in) :: c(:)
      type(circuit_position_t), intent(in) :: a, b

      is_same = all(a%branch == b%branch)
      if (is_same) is_same = are_further(c, a, b, 0.0_wp)
   end function is_same

   !> Every value of `a` is that of `b`, on the same branches, and `further`.
   pure logical function are_further(c, a, b, further) result(are)
      type(component_t), intent(in) :: c(:)
      type(circuit_position_t), intent(in) :: a, b
      real(wp), intent(in) :: further
      real(wp) :: off
      integer :: i

      are = .true.
      do i = 1, size(c)
         off = a%value(i) - b%value(i) - further
         associate (period => c(i)%period(a%branch(i)))
            if (period > 0.0_wp) off = off - period*anint(off/period)
         end associate
         are = abs(off) < same_value
         if (.not. are) return
      end do
   end function are_further

   !> The position `s` is on the circuit `one`.
   pure logical function is_on(c, one, s)
      type(component_t), intent(in) :: c(:)
      type(walk_t), intent(in) :: one
      type(circuit_position_t), intent(in) :: s
      real(wp) :: further, step
      integer :: l

      is_on = .false.
      do l = 1, size(one%legs)
         associate (leg => one%legs(l))
            if (any(s%branch /= leg%low%branch)) cycle
            further = s%value(1) - leg%low%value(1)
            step = c(1)%period(s%branch(1))
            if (step > 0.0_wp) further = modulo(further + same_value, step) - same_value
            do while (further < leg%length + same_value)
               is_on = further > -same_value .and. are_further(c, s, leg%low, further)
               if (is_on) return
               if (step <= 0.0_wp) exit
               further = further + step
            end do
         end associate
      end do
   end function is_on

   !> The drive's way after which all components are where they were, on closed `branch` (components) each.
   pure real(wp) function common_period(c, branch) result(period)
      type(component_t), intent(in) :: c(:)
      integer, intent(in) :: branch(:)
      integer :: turns, one, i, k

      turns = 1
      do i = 1, size(c)
         one = nint(c(i)%period(branch(i))/(2.0_wp*pi))
         do k = 1, one
            if (modulo(k*turns, one) == 0) exit
         end do
         turns = k*turns
      end do
      period = 2.0_wp*pi*turns
   end function common_period
end module circuit_walk
