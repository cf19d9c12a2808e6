!> The dwells of card EXTREMES: how long a coordinate stays within a distance of its least or greatest value.
module dwells
   use kinds, only: wp
   use mechanism, only: mechanism_t
   use points, only: coordinates_of
   use set_analysis, only: set_analysis_t
   use zero_search, only: sample_t, column_t, find_zero, noise_part
   use extremes, only: extremes_t, least, greatest, is_angle, is_cyclic, is_covered
   implicit none
   private
   public :: dwells_t, dwell_t, new_dwells, note_position, find_dwells

   !> Column `column` (1 to 3) of the asked row number `asked` is within `distance` of its extreme `which` (least or
   !> greatest) between these times; in a cyclic motion `to` may come before `from`.
   type :: dwell_t
      integer :: asked = 0, column = 0, which = least
      real(wp) :: distance = 0.0_wp                    !< in the deck's unit or rad
      real(wp) :: from = 0.0_wp, to = 0.0_wp           !< times
      real(wp) :: error(2) = 0.0_wp                    !< what rounding leaves open of both
   end type dwell_t

   !> The coordinates whose dwells are asked for, at all instants of TIME.
   type :: dwells_t
      type(dwell_t), allocatable :: wanted(:)          !< (columns)
      integer :: last = -1                             !< the number of the last instant
      real(wp), allocatable :: t(:)                    !< (0:instants) times
      real(wp), allocatable :: value(:, :)             !< (columns, 0:instants)
   end type dwells_t

contains

   !> Ready for the first instant of `m`; `x`: its extremes.
   subroutine new_dwells(m, x, d)
      type(mechanism_t), intent(in) :: m
      type(extremes_t), intent(in) :: x
      type(dwells_t), intent(out) :: d
      real(wp) :: distance
      integer :: q, c

      allocate (d%wanted(0))
      do q = 1, size(x%asked)
         associate (request => m%requests(x%asked(q)))
            do c = 1, coordinates_of(request%kind)
               distance = request%dwell(merge(2, 1, is_angle(m, request, c)))
               if (distance > 0.0_wp) d%wanted = [d%wanted, dwell_t(q, c, distance=distance)]
            end do
         end associate
      end do
      if (size(d%wanted) > 0) allocate (d%t(0:m%steps), d%value(size(d%wanted), 0:m%steps))
   end subroutine new_dwells

   !> Takes instant number `k`, which `x` has taken.
   subroutine note_position(d, x, k)
      type(dwells_t), intent(inout) :: d
      type(extremes_t), intent(in) :: x
      integer, intent(in) :: k
      integer :: i

      if (size(d%wanted) == 0) return
      d%last = k
      do i = 1, size(d%wanted)
         associate (w => d%wanted(i), now => x%tracks(x%part(d%wanted(i)%asked))%instant)
            d%t(k) = now%t
            d%value(i, k) = now%value(w%column, 0, w%asked)
         end associate
      end do
   end subroutine note_position

   !> The dwells (any number) after the last instant; none of what never leaves its distance, and none at all where some
   !> of the motion between instants is not known.
   subroutine find_dwells(d, m, x, s, list)
      type(dwells_t), intent(in) :: d
      type(mechanism_t), intent(in) :: m
      type(extremes_t), intent(in) :: x
      type(set_analysis_t), intent(inout) :: s
      type(dwell_t), allocatable, intent(out) :: list(:)
      type(dwell_t) :: one
      integer :: i, which
      real(wp) :: stroke
      logical :: is_cycle, found(2)

      allocate (list(0))
      if (.not. is_covered(x)) return
      do i = 1, size(d%wanted)
         one = d%wanted(i)
         stroke = x%found(greatest, one%column, 0, one%asked)%value - x%found(least, one%column, 0, one%asked)%value
         if (stroke <= one%distance) cycle
         ! A crank that has made whole turns is not where it was.
         is_cycle = abs(d%value(i, d%last) - d%value(i, 0)) < 0.5_wp*stroke &
            .and. is_cyclic(x, m, one%asked)
         do which = least, greatest
            one%which = which
            call find_end(d, i, x, s, which, -1, is_cycle, one%from, one%error(1), found(1))
            call find_end(d, i, x, s, which, 1, is_cycle, one%to, one%error(2), found(2))
            if (all(found)) list = [list, one]
         end do
      end do
   end subroutine find_dwells

   !> The time `t` at which wanted column `i`, followed from its extreme `which` along the run (`way` 1) or against it
   !> (-1), leaves its distance, and its `error`; the end of the run where it does not, unless the motion is a cycle and
   !> goes on.
   subroutine find_end(d, i, x, s, which, way, is_cycle, t, error, found)
      type(dwells_t), intent(in) :: d
      integer, intent(in) :: i, which, way
      type(extremes_t), intent(in) :: x
      type(set_analysis_t), intent(inout) :: s
      logical, intent(in) :: is_cycle
      real(wp), intent(out) :: t, error
      logical, intent(out) :: found
      type(sample_t) :: inside, outside, zero
      real(wp) :: level
      integer :: k, passed

      found = .true.
      error = 0.0_wp
      associate (w => d%wanted(i), e => x%found(which, d%wanted(i)%column, 0, d%wanted(i)%asked))
         level = e%value + merge(w%distance, -w%distance, which == least)
         inside = position_at(e%t, e%value)
         k = next_instant(d, e%t, way)
         do passed = 0, d%last
            t = inside%t
            if (k < 0 .or. k > d%last) then
               if (.not. is_cycle) return
               ! On from the other end, in the same position.
               k = merge(0, d%last, way > 0)
            end if
            outside = position_at(d%t(k), d%value(i, k))
            if ((outside%f(0) - level)*merge(1.0_wp, -1.0_wp, which == least) > 0.0_wp) exit
            inside = outside
            k = k + way
         end do
         if (passed > d%last) return
         call find_zero(s, column_t(x%asked(w%asked), w%column, &
            noise=noise_part*x%size_of(w%column, :, w%asked)), 0, level, inside, outside, zero)
         ! The level is known as far as the extreme.
         error = zero%t_error
         if (zero%error(0) > 0.0_wp) error = error*(1.0_wp + e%error/zero%error(0))
      end associate
      t = zero%t
      found = zero%exists
   end subroutine find_end

   !> The number of the first instant after the time `t` along the run (`way` 1) or against it (-1).
   pure integer function next_instant(d, t, way) result(k)
      type(dwells_t), intent(in) :: d
      real(wp), intent(in) :: t
      integer, intent(in) :: way

      k = merge(0, d%last, way > 0)
      do while (k >= 0 .and. k <= d%last)
         if ((d%t(k) - t)*way*(d%t(d%last) - d%t(0)) > 0.0_wp) exit
         k = k + way
      end do
   end function next_instant

   !> A coordinate alone.
   pure type(sample_t) function position_at(t, value) result(sample)
      real(wp), intent(in) :: t, value

      sample = sample_t(t, [value, 0.0_wp, 0.0_wp], exists=.true.)
   end function position_at
end module dwells
