!> The dwells of card EXTREMES: how long a coordinate stays within a distance of its least or greatest value, each
!> time.
module dwells
   use kinds, only: wp
   use set_analysis, only: set_analysis_t
   use nodes, only: order_along
   use zero_search, only: sample_t, column_t, find_zero, noise_part
   use extremes, only: extremes_t, value_at_t, least, greatest, outward, is_cyclic, is_covered
   implicit none
   private
   public :: dwell_t, find_dwells

   !> Column `column` (1 to 3) of the asked row number `asked` is within `distance` of its extreme `which` (least or
   !> greatest) between these times; in a cyclic motion `to` may come before `from`.
   type :: dwell_t
      integer :: asked = 0, column = 0, which = least
      real(wp) :: distance = 0.0_wp                    !< in the deck's unit or rad
      real(wp) :: from = 0.0_wp, to = 0.0_wp           !< times
      real(wp) :: error(2) = 0.0_wp                    !< what rounding leaves open of both
   end type dwell_t

contains

   !> The dwells (any number) of the set that `s` has analysed, after its last instant, by its extremes `x`; none
   !> of what never leaves its distance, and none at all where some of the motion between instants is not known.
   subroutine find_dwells(x, s, list)
      type(extremes_t), intent(in) :: x
      type(set_analysis_t), intent(inout) :: s
      type(dwell_t), allocatable, intent(out) :: list(:)
      type(dwell_t) :: one
      type(value_at_t), allocatable :: path(:)
      logical, allocatable :: inside(:), before(:)
      integer :: q, c, which, k
      real(wp) :: stroke, level
      logical :: is_cycle, found(2)

      allocate (list(0))
      if (.not. is_covered(x)) return
      do q = 1, size(x%asked)
         do c = 1, x%columns(q)
            one = dwell_t(q, c, distance=x%dwell(c, q))
            stroke = x%found(greatest, c, 0, q)%value - x%found(least, c, 0, q)%value
            if (one%distance <= 0.0_wp .or. stroke <= one%distance) cycle
            associate (places => x%places%list(:x%places%n))
               path = pack(places, places%asked == q .and. places%column == c)
            end associate
            ! They are in order but for extremes beside the middle of a part.
            path = path(order_along(path%t, x%way))
            ! A crank that has made whole turns is not where it was.
            is_cycle = abs(path(size(path))%value - path(1)%value) < 0.5_wp*stroke .and. is_cyclic(x, q)

            do which = least, greatest
               one%which = which
               level = x%found(which, c, 0, q)%value - outward(which)*one%distance
               inside = (path%value - level)*outward(which) >= 0.0_wp
               ! Each begins at a place inside after one outside; in a cycle the last place is before the first.
               before = cshift(inside, -1)
               before(1) = is_cycle .and. before(1)
               do k = 1, size(path)
                  if (.not. inside(k) .or. before(k)) cycle
                  call find_end(one, path, level, k, x, s, -1, is_cycle, one%from, one%error(1), found(1))
                  call find_end(one, path, level, k, x, s, 1, is_cycle, one%to, one%error(2), found(2))
                  if (all(found)) list = [list, one]
               end do
            end do
         end do
      end do
   end subroutine find_dwells

   !> The time `t` at which the coordinate `w`, followed on its `path` from place number `start` along the run (`way` 1)
   !> or against it (-1), passes the `level`, and its `error`; the end of the run where it does not, unless the motion
   !> is a cycle and goes on.
   subroutine find_end(w, path, level, start, x, s, way, is_cycle, t, error, found)
      type(dwell_t), intent(in) :: w
      type(value_at_t), intent(in) :: path(:)
      real(wp), intent(in) :: level
      integer, intent(in) :: start, way
      type(extremes_t), intent(in) :: x
      type(set_analysis_t), intent(inout) :: s
      logical, intent(in) :: is_cycle
      real(wp), intent(out) :: t, error
      logical, intent(out) :: found
      type(sample_t) :: inside, outside, zero
      integer :: k, passed

      found = .true.
      error = 0.0_wp
      associate (e => x%found(w%which, w%column, 0, w%asked), n => size(path))
         inside = sample_t(path(start)%t, [path(start)%value, 0.0_wp, 0.0_wp], exists=.true.)
         k = start + way
         do passed = 1, n
            t = inside%t
            if (k < 1 .or. k > n) then
               if (.not. is_cycle) return
               ! On from the other end, in the same position.
               k = merge(1, n, way > 0)
            end if
            outside = sample_t(path(k)%t, [path(k)%value, 0.0_wp, 0.0_wp], exists=.true.)
            if ((outside%f(0) - level)*outward(w%which) < 0.0_wp) exit
            inside = outside
            k = k + way
         end do
         if (passed > n) return
         call find_zero(s, column_t(x%asked(w%asked), w%column, &
            noise=noise_part*x%size_of(w%column, :, w%asked)), 0, level, inside, outside, zero)
         ! The level is known as far as the extreme.
         error = zero%t_error
         if (zero%error(0) > 0.0_wp) error = error*(1.0_wp + e%error/zero%error(0))
      end associate
      t = zero%t
      found = zero%exists
   end subroutine find_end
end module dwells
