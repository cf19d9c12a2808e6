!> The dwells of card EXTREMES: how long a coordinate stays within a distance of its least or greatest value, each
!> time.
module dwells
   use kinds, only: wp
   use set_analysis, only: set_analysis_t
   use nodes, only: sample_t, order_along
   use zero_search, only: column_t, find_zero, noise_part
   use extremes, only: extremes_t, value_at_t, least, greatest, outward, is_cyclic, is_covered
   implicit none
   private
   public :: dwell_t, find_dwells

   !> A column of the row of a request is within a distance of its extreme between two times. In a cyclic motion `to`
   !> may come before `from`.
   type :: dwell_t
      integer :: request = 0                           !< number in the set
      integer :: column = 0                            !< of the row: 1 to 3
      integer :: which = least                         !< the extreme: least or greatest
      real(wp) :: distance = 0.0_wp                    !< in the deck's unit or rad
      real(wp) :: from = 0.0_wp, to = 0.0_wp           !< times
      real(wp) :: error(2) = 0.0_wp                    !< errors of both times by rounding
   end type dwell_t

contains

   !> Finds the dwells of a set after its last instant, by its extremes. A coordinate that never leaves its distance has
   !> none. If some of the motion between instants is not known, there are none at all.
   subroutine find_dwells(extremes, set, list)
      type(extremes_t), intent(in) :: extremes   !< after the last instant
      type(set_analysis_t), intent(inout) :: set   !< after its last instant; the analyses move
      type(dwell_t), allocatable, intent(out) :: list(:)   !< (any number)
      type(dwell_t) :: one
      type(value_at_t), allocatable :: path(:)
      logical, allocatable :: inside(:), before(:)
      integer :: i, c, which, k
      real(wp) :: stroke, level
      logical :: is_cycle, found(2)

      allocate (list(0))
      if (.not. is_covered(extremes)) return
      do c = 1, size(extremes%tracks)
         do i = 1, size(extremes%tracks(c)%coordinates)
            associate (moved => extremes%tracks(c)%coordinates(i))
               one = dwell_t(moved%request, moved%column, distance=moved%dwell)
               stroke = moved%found(greatest, 0)%value - moved%found(least, 0)%value
               if (one%distance <= 0.0_wp .or. stroke <= one%distance) cycle
               ! They are in order but for extremes near the middle of a part.
               path = moved%places(order_along(moved%places%t, extremes%way))
               ! A crank that has made whole turns has another value.
               is_cycle = abs(path(size(path))%value - path(1)%value) < 0.5_wp*stroke .and. is_cyclic(extremes, c)

               do which = least, greatest
                  one%which = which
                  level = moved%found(which, 0)%value - outward(which)*one%distance
                  inside = (path%value - level)*outward(which) >= 0.0_wp
                  ! A dwell begins at a place inside after one outside; in a cycle the last place is before the first.
                  before = cshift(inside, -1)
                  before(1) = is_cycle .and. before(1)
                  do k = 1, size(path)
                     if (.not. inside(k) .or. before(k)) cycle
                     call find_end(k, -1, one%from, one%error(1), found(1))
                     call find_end(k, 1, one%to, one%error(2), found(2))
                     if (all(found)) list = [list, one]
                  end do
               end do
            end associate
         end do
      end do

   contains

      !> Finds the time at which the coordinate, followed on its path from a place, passes the level. If it does not,
      !> the end of the run is the time; in a cycle the path goes on from the other end.
      subroutine find_end(start, way, t, error, found)
         integer, intent(in) :: start        !< number of the place on the path
         integer, intent(in) :: way          !< 1: along the run; -1: against it
         real(wp), intent(out) :: t          !< time
         real(wp), intent(out) :: error      !< the error of `t` by rounding
         logical, intent(out) :: found       !< the time is known: `find_zero` has found it, or the run ends
         type(sample_t) :: zero
         integer :: from, to, passed

         found = .true.
         error = 0.0_wp
         to = start
         do passed = 1, size(path)
            from = to
            t = path(from)%t
            to = from + way
            if (to < 1 .or. to > size(path)) then
               if (.not. is_cycle) return
               ! The path goes on from the other end, where the position is equal.
               to = merge(1, size(path), way > 0)
            end if
            if (.not. inside(to)) exit
         end do
         if (passed > size(path)) return
         associate (moved => extremes%tracks(c)%coordinates(i))
            call find_zero(set, column_t(moved%request, moved%column, noise=noise_part*moved%size_of), 0, level, &
               sample_t(path(from)%t, [path(from)%value, 0.0_wp, 0.0_wp], known=2), &
               sample_t(path(to)%t, [path(to)%value, 0.0_wp, 0.0_wp], known=2), zero)
            ! The level is known as far as the extreme.
            error = zero%t_error
            if (zero%error(0) > 0.0_wp) error = error*(1.0_wp + moved%found(one%which, 0)%error/zero%error(0))
         end associate
         t = zero%t
         found = zero%known == 2
      end subroutine find_end
   end subroutine find_dwells
end module dwells
