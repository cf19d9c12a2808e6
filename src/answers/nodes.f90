!> The rows of some requests of a set at the instants of TIME and at times between them, where what is asked of the
!> whole run looks for something.
module nodes
   use kinds, only: wp
   use mechanism, only: mechanism_t, instant
   use points, only: row_t, row_of
   use set_analysis, only: set_analysis_t, rows_at
   implicit none
   private
   public :: node_t, node_of_instant, node_at, times_between

   !> How far from an end or a joint the next node is, in steps of TIME: so that an extreme beside it is seen.
   real(wp), parameter :: beside_part = 1.0_wp/1024.0_wp
   !> Just before a joint, in parts of the time or of the run: `drives` takes what is nearer as the joint itself.
   real(wp), parameter :: just_before = 65536.0_wp*epsilon(1.0_wp)

   !> The rows at one time.
   type :: node_t
      real(wp) :: t = 0.0_wp                           !< time
      integer, allocatable :: known(:)                 !< (asked) as in `row_t`
      real(wp), allocatable :: value(:, :, :)          !< (3, 0:2, asked) in the deck's units and rad
   end type node_t

contains

   !> The rows of the requests `asked` at the last instant of `s`.
   function node_of_instant(asked, s) result(node)
      integer, intent(in) :: asked(:)
      type(set_analysis_t), intent(in) :: s
      type(node_t) :: node
      type(row_t) :: row
      integer :: q

      node = empty_node(size(asked))
      node%t = s%now%motions(1)%t
      do q = 1, size(asked)
         associate (c => s%now%parts%part(asked(q)), i => s%now%parts%number(asked(q)))
            row = row_of(s%now%own(c), s%now%motions(c), s%now%own(c)%requests(i))
         end associate
         node%known(q) = row%known
         node%value(:, :, q) = row%value
      end do
   end function node_of_instant

   !> The same at a time `t` between the instants.
   function node_at(asked, s, t) result(node)
      integer, intent(in) :: asked(:)
      type(set_analysis_t), intent(inout) :: s
      real(wp), intent(in) :: t
      type(node_t) :: node
      type(row_t), allocatable :: rows(:)
      integer, allocatable :: these(:)
      integer :: c, i
      logical :: is_found

      node = empty_node(size(asked))
      node%t = t
      do c = 1, s%now%parts%count
         these = pack([(i, i=1, size(asked))], s%now%parts%part(asked) == c)
         if (size(these) == 0) cycle
         allocate (rows(size(these)))
         call rows_at(s, c, asked(these), t, rows, is_found)
         if (is_found) node%known(these) = 2
         do i = 1, size(these)
            node%value(:, :, these(i)) = rows(i)%value
         end do
         deallocate (rows)
      end do
   end function node_at

   !> A node of `n` rows of which nothing is known yet.
   pure type(node_t) function empty_node(n) result(node)
      integer, intent(in) :: n

      allocate (node%known(n), source=-1)
      allocate (node%value(3, 0:2, n), source=0.0_wp)
   end function empty_node

   !> The times of the nodes between instants number `k` - 1 and `k`, in their order: on either side of each of the
   !> `joints` of the drives' laws, and beside the ends of the run.
   pure function times_between(joints, m, k) result(times)
      real(wp), intent(in) :: joints(:)
      type(mechanism_t), intent(in) :: m
      integer, intent(in) :: k
      real(wp), allocatable :: times(:)
      real(wp) :: t1, t2, h
      integer :: i

      t1 = instant(m, k - 1)
      t2 = instant(m, k)
      h = t2 - t1
      allocate (times(0))
      if (k == 1) times = [t1 + beside_part*h]
      if (k == m%steps) times = [times, t2 - beside_part*h]
      do i = 1, size(joints)
         associate (t => joints(i))
            times = [times, t - sign(just_before*max(abs(t), abs(m%t1 - m%t0)), h), t, t + beside_part*h]
         end associate
      end do
      times = pack(times, (times - t1)/h > 0.0_wp .and. (times - t1)/h < 1.0_wp)
      call sort_along(times, h)
   end function times_between

   !> Sorts `times` upwards where `h` > 0, otherwise downwards.
   pure subroutine sort_along(times, h)
      real(wp), intent(inout) :: times(:)
      real(wp), intent(in) :: h
      real(wp) :: t
      integer :: i, k

      do i = 2, size(times)
         t = times(i)
         do k = i - 1, 1, -1
            if ((times(k) - t)*sign(1.0_wp, h) <= 0.0_wp) exit
            times(k + 1) = times(k)
         end do
         times(k + 1) = t
      end do
   end subroutine sort_along

end module nodes
